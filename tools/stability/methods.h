// All methods of each system: the engines in every precision, and the naive methods.
#pragma once

#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_run.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/stability/case.h"

namespace ballpiston::stability {

using PairMethod = Method<PairGeometry, PairState>;
using GasMethod = Method<GasGeometry, GasStart>;

std::vector<PairMethod> BallMethods();
std::vector<PairMethod> PairMethods();
std::vector<GasMethod> GasMethods();

}  // namespace ballpiston::stability
