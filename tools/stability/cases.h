// All situations of each system in which methods fail, and all methods: the engines in every
// precision, and the naive methods.
#pragma once

#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_run.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/stability/case.h"

namespace ballpiston::stability {

using PairCase = Case<PairGeometry, PairState>;
using GasCase = Case<GasGeometry, GasStart>;

using PairMethod = Method<PairGeometry, PairState>;
using GasMethod = Method<GasGeometry, GasStart>;

// Cases of the same system have the same random numbers.
std::vector<PairCase> BallCases();
std::vector<PairCase> PairCases();
std::vector<GasCase> GasCases();

std::vector<PairMethod> BallMethods();
std::vector<PairMethod> PairMethods();
std::vector<GasMethod> GasMethods();

}  // namespace ballpiston::stability
