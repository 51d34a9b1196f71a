// The places where methods fail that need a gas, and how each method does there.
#ifndef BALLPISTON_TOOLS_STABILITY_GAS_CASES_H_
#define BALLPISTON_TOOLS_STABILITY_GAS_CASES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "tools/stability/failures.h"
#include "tools/stability/gas_methods.h"
#include "tools/stability/gas_starts.h"

namespace ballpiston::stability {

struct GasCase {
  std::string name;
  std::vector<GasGeometry> geometries;
  DrawGasStart* start;
  uint64_t starts;  // for each geometry, in the full table
  double flights;   // of a ball of speed 1, the time of each
  double hot = 1;   // temperatures of thermal walls, where there are some; the fastest body's
  double cold = 1;  // energy is 1/2
};

const std::vector<GasCase>& GasCases();

Failures RunGasCase(const GasCase& gas_case, const GasMethod& method, double effort);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_GAS_CASES_H_
