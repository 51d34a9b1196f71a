// Why which model answers, below a table: each reason once, however many points share it.
//
//   closed-form: exact                                          one reason for all points
//
//   markov (rho 0.53, delta 0.0125): off by 1.2e-03             several: with the first point
//   billiard (rho 0.53, delta 0.1 and 2 more points): ...       of each
#ifndef BALLPISTON_CLIENT_OUTPUT_MODEL_REASONS_H_
#define BALLPISTON_CLIENT_OUTPUT_MODEL_REASONS_H_

#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::client {

// As users write it; "none" if no model answers.
std::string ModelName(v1::EnsembleSpec::Model model);

class ModelReasons {
 public:
  // Nothing if there is no reason: the model was asked for.
  void Add(const v1::PointParameters& parameters, v1::EnsembleSpec::Model model,
           const std::string& reason);

  // In the order of their first points.
  void Print(std::ostream& out) const;

 private:
  struct Reason {
    std::string model, text;
    v1::PointParameters first_point;
    int points = 0;
  };

  std::string Line(const Reason& reason) const;

  std::vector<Reason> reasons_;
  std::map<std::pair<std::string, std::string>, size_t> position_;  // by model and text
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_MODEL_REASONS_H_
