// A point's parameters as text. Those that the experiment does not use are absent.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::client {

// epsilon, exponent, cells, temperature, hot, cold.
inline constexpr size_t kOptionalParameters = 6;

// "rho 0.53, delta 0.2, epsilon 0.25, exponent 1", with ten digits each.
std::string ParameterText(const v1::PointParameters& parameters);

// The parameters in CSV: rho, delta, epsilon and exponent in every file; cells, temperature, hot
// and cold if the specification's grid has them. Numbers are exact; absent parameters are empty.
class ParameterColumns {
 public:
  explicit ParameterColumns(const v1::Grid& grid);

  std::vector<std::string> Titles() const;
  std::vector<std::string> Cells(const v1::PointParameters& parameters) const;

 private:
  std::array<bool, kOptionalParameters> shown_;
};

// The parameters in tables: rho, delta, and every other parameter that at least one point has, with
// ten digits each.
class ParametersShown {
 public:
  void Include(const v1::PointParameters& parameters);  // adds this point's parameters
  std::vector<std::string> Titles() const;
  std::vector<std::string> Cells(const v1::PointParameters& parameters) const;

 private:
  std::array<bool, kOptionalParameters> shown_ = {};
};

}  // namespace ballpiston::client
