// Upper bound of the difference between the relaxation time of the limit delta -> 0 and that of the
// billiard at a given delta. The form of the bound follows from the mechanisms; its constants are
// fitted to measurements.
//
// In equilibrium, with x = (lambda + 2 delta)/tau_bp, the bound of the relative difference is
//
//   (0.6 + 2.2 (lambda delta/bound)^2) x log(1 + 1/x) + cusp
//   cusp = 0.24 exp(-(lambda/0.19)^2) delta^2/(delta^2 + (lambda/4)^2)
//
// A slow piston needs a mean free time or longer to cross its interval of lambda + 2 delta. It
// returns after a fixed period, not at a random time. This gives the term x log(1/x), of order
// delta^2 log(1/delta). Near delta's bound, and in cells with narrow tips (lambda << 1), the
// difference is larger: collisions of the same ball and piston follow each other more often than at
// random. The two terms for these cases are fitted to measurements.
//
// From a given energy the same delays change the decay integral, in mean free times by up to
//
//   0.45 x log(1 + 1/x) max(1, 0.16/u) + 0.35 2 tip/(v tau_bp) + 0.1 cusp/v
//
// u and v are the speeds of piston and ball at that energy. The bound is never larger than the
// difference of a pair that does not relax at all within the window. The relative error is this
// bound over the limit's decay integral, which passes through 0 at epsilon = 0.141. So it is large
// near the energies for which no relaxation time is given.
//
// Coverage: at least 95 % of billiard runs over rho from 0.501 to 0.705, delta from 0.01 (or a
// tenth of its bound, if that is less) to its bound, no epsilon or an epsilon from 0.01 to 0.49. It
// was measured at 60 random points that were not used for the constants. Of these, 55 have a
// standard error below half of the bound: 1 of the 55 is outside, by 0.3 of its standard error.
// None of the 60 is outside by more than 2 standard errors. Test:
// LimitError.StatedErrorCoversTheBilliard. Below delta = 0.01 the bound rests on the scaling alone.
#ifndef BALLPISTON_CORE_EXPERIMENT_EXPECTED_LIMIT_ERROR_H_
#define BALLPISTON_CORE_EXPERIMENT_EXPECTED_LIMIT_ERROR_H_

#include "core/ensemble/parameter.h"

namespace ballpiston {

// Upper bound of |billiard - limit|/limit of the relaxation time. Requires rho and delta, and with
// an epsilon one that has a relaxation time.
double ExpectedLimitError(const PointParameters& point);

// Upper bound of |billiard - limit|/limit of the heat conduction of a gas. Requires rho and delta.
// The mechanisms by which a pair's exchanges differ from random ones also act in a gas, where each
// ball meets more pistons. So this is the bound of the pair in equilibrium times a measured factor
// (docs/gas.md).
double ExpectedLimitErrorOfConduction(const PointParameters& point);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_EXPECTED_LIMIT_ERROR_H_
