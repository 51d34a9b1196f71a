// The situations of a gas in which methods fail, and the failures of each method there.
#pragma once

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
  double flights;   // the duration of each run, in flights of a ball of speed 1
  double hot = 1;   // temperatures of the thermal walls, if there are any; the energy of the
  double cold = 1;  // fastest body is 1/2
};

const std::vector<GasCase>& GasCases();

Failures RunGasCase(const GasCase& gas_case, const GasMethod& method, double effort);

}  // namespace ballpiston::stability
