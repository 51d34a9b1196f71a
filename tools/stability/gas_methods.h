// The methods that run gases. Each method is one function.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/gas/thermal_walls.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

struct GasReplica {
  GasState state;
  ThermalWalls walls;
  GasRandom random;
};

struct GasMethod {
  std::string name;
  double share;   // of a case's starts
  bool promised;  // the method promises zeros everywhere

  // Each replica runs for the time of `flights` flights of a ball of speed 1.
  Failures (*run)(const GasGeometry& geometry, std::span<const GasReplica> replicas,
                  double flights);
};

const std::vector<GasMethod>& GasMethods();

}  // namespace ballpiston::stability
