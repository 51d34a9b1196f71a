// A point's parameters as text. Those that the experiment does not use are absent.
#pragma once

#include <algorithm>
#include <string>

#include "ballpiston/v1/spec.pb.h"
#include "client/output/field_text.h"

namespace ballpiston::client {

std::string TenDigits(double x);

// "rho 0.53, delta 0.2, epsilon 0.25, exponent 1", with ten digits each.
std::string ParameterText(const v1::PointParameters& parameters);

// The names of the parameters in CSV: rho, delta, epsilon and exponent in every file; cells,
// temperature, hot and cold if the specification's grid has them.
Cells ParametersInCsv(const v1::Grid& grid);

// The names of the parameters in a table: rho, delta, and every other parameter that at least one
// point has. `points`: PointResults or PointPlans.
template <typename Points>
Cells ParametersOf(const Points& points) {
  Cells names = FieldNames(*v1::PointParameters::descriptor());
  std::erase_if(names, [&points](const std::string& name) {
    if (name == "rho" || name == "delta") return false;
    return std::all_of(points.begin(), points.end(), [&name](const auto& point) {
      return FieldText(point.parameters(), name).empty();
    });
  });
  return names;
}

}  // namespace ballpiston::client
