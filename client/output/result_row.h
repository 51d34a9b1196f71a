// A point's estimates as rows, the shape that tables and CSV share.
#ifndef BALLPISTON_CLIENT_OUTPUT_RESULT_ROW_H_
#define BALLPISTON_CLIENT_OUTPUT_RESULT_ROW_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ballpiston/v1/result.pb.h"

namespace ballpiston::client {

struct ResultRow {
  ResultRow(std::string name, double value) : name(std::move(name)), value(value) {}

  std::string name;
  double value;
  std::optional<double> standard_error;
  std::optional<double> exact;
  std::optional<double> z_score;
  std::optional<double> model_error;
  std::optional<double> noise_floor;
  std::optional<double> limit;
};

// The estimates in their order, then kl_divergence and kl_noise_floor where they exist.
std::vector<ResultRow> ResultRows(const v1::PointResult& point);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_RESULT_ROW_H_
