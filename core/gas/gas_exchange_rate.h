// The exact rate at which a ball and a piston of the gas exchange energy in the canonical ensemble.
//
//   rate = sqrt(T/(2 pi)) |dG_bp|/(stroke cell) F(z),   z = Q/(stroke cell),   F(0) = 1,
//
// where stroke = lambda + 2 delta, and Q is the mean area that a piston cuts off from the cell on
// one of its sides, times stroke. For the pair |G| = stroke cell - Q, which corresponds to
// F = 1/(1 - z). In the gas every piston takes area from two cells. The parts of a cell that its
// pistons cut off do not overlap. So its free area is the cell minus one part for each piston, and
// the configuration integral is a polynomial in z, derived in gas_exchange_rate.cc.
//
// At the paper's rho and delta = 0.2 the rate is 2.4 % above that of a pair in a chain and 4.9 % in
// a lattice; the difference falls as delta^3.
//
// Units and domain as in closed_form/exchange_rate.h. A rate counts the exchanges of one contact (a
// ball and a piston) per unit of time. Properties, each with the test that bears its name:
//   1. RingsAreTracesOfTheirTransferOperator.  2. ToriCountEveryConfiguration.
//   3. LargeGasesTendToTheInfiniteOne, to kGasExchangeRateRelativeError.
#pragma once

#include "core/gas/gas_geometry.h"

namespace ballpiston {

inline constexpr double kGasExchangeRateRelativeError = 1e-12;

// The rate of a periodic gas of this shape. For a gas between reservoirs the function returns the
// rate of the infinite gas.
double GasExchangeRate(const GasGeometry& geometry, double temperature);

// The rate of the infinite chain or lattice.
double InfiniteGasExchangeRate(const GasGeometry& geometry, double temperature);

// F of the periodic gas of this shape, and of the infinite one. Domain: 0 <= z <= 0.02.
double CrowdingFactor(const GasShape& shape, double z);
double InfiniteCrowdingFactor(bool is_lattice, double z);

}  // namespace ballpiston
