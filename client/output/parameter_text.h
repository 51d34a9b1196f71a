// A point's parameters as text. Those that the experiment does not use are absent.
#ifndef BALLPISTON_CLIENT_OUTPUT_PARAMETER_TEXT_H_
#define BALLPISTON_CLIENT_OUTPUT_PARAMETER_TEXT_H_

#include <string>
#include <vector>

#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::client {

// rho 0.53, delta 0.2, epsilon 0.25, exponent 1; ten digits each.
std::string ParameterText(const v1::PointParameters& parameters);

// For CSV: rho, delta, epsilon, exponent; exact; empty if absent.
std::vector<std::string> ParameterColumns(const v1::PointParameters& parameters);

// For tables: the same as far as a column is wanted, ten digits each.
struct ParametersShown {
  bool epsilon = false;
  bool exponent = false;

  void Include(const v1::PointParameters& parameters);  // what it has is shown from now on
  std::vector<std::string> Titles() const;
  std::vector<std::string> Cells(const v1::PointParameters& parameters) const;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_PARAMETER_TEXT_H_
