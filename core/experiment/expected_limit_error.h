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
//   0.45 x log(1 + 1/x) max(1, 0.16/u) + 0.1 cusp/v + (1/3) m (1 - exp(-8/m))
//   m = 0.7 (1/sqrt 2) p^3/(p^2 + 2.5),  p = delta/(min(2 tip, stroke) v)
//
// u and v are the speeds of piston and ball at that energy. The last term belongs to a slow ball,
// which leaves the depth delta slowly. The fast piston crosses its stroke and meets the ball there
// again: hits come in clusters, and the first one comes late. An exchange gives the slow piston to
// the ball's place: the ball, now fast, crosses its cell of length 2 tip and returns before the
// piston has left, and takes the energy back. So the pair keeps its energy for longer, m mean free
// times more, of which the window of 8 counts. The constants cover 510 random places.
// 1/sqrt 2 is the limit's mean time to the hit of a ball at rest. The bound is never larger than
// the difference of a pair that does not relax at all within the window. The relative error is this
// bound over the limit's decay integral, which passes through 0 at epsilon = 0.141. So it is large
// near the energies for which no relaxation time is given.
//
// The heat current of a gas. A piston that leaves the cold wall at temperature T_c has the flux
// law, whose mean of 1/speed is sqrt(pi/(2 T_c)), so it needs a time of order stroke/sqrt(T_c) to
// the ball; the jump process has no such time. In units of the gas's mean temperature T this time
// delays the exchanges at the wall by d, relative to the time of the exchanges of a row of N cells:
//
//   y = nu stroke (sqrt(T/T_c) - 1) 2/(N + 1),   d = y max(1.3, 0.8 + ln(1 + 0.3/y)),
//   error = E + (1 - E) d/(1 + d)
//
// with the exchange rate nu at T = 1, and E for T_c = T. As T_c falls to 0, the current falls as
// sqrt(T_c), and the error tends to 1. The factor covers all measured places, less
// two of their standard errors; where d is short the slow pistons make it grow as a logarithm.
//
// Coverage: at each place of tests/data/model_errors.csv the difference less two of its standard
// errors is within the bound; these places include the ends of rho, delta, epsilon and cold/hot
// (docs/research/markov-limit.md argues by scaling for the places where the billiard is too
// expensive). The random questions of tests/questions compare the models at other points.
#pragma once

#include "core/ensemble/parameter.h"

namespace ballpiston {

// Upper bound of |billiard - limit|/limit of the relaxation time. Requires rho and delta, and with
// an epsilon one that has a relaxation time.
double ExpectedLimitError(const PointParameters& point);

// Upper bound of |billiard - limit|/limit of the conductivity of a gas at nearly one temperature.
// Requires rho and delta. The mechanisms by which a pair's exchanges differ from random ones also
// act in a gas, where each ball meets more pistons. So this is the bound of the pair in equilibrium
// times a measured factor (docs/gas.md).
double ExpectedLimitErrorInAGas(const PointParameters& point);

// Upper bound of |billiard - limit|/limit of the heat current between two reservoirs: that of the
// gas, and the share that slow pistons of the cold reservoir take, as above. Requires rho, delta,
// cells, hot and cold.
double ExpectedLimitErrorOfConduction(const PointParameters& point);

}  // namespace ballpiston
