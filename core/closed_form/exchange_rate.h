// The averages of the kernel's moments over the canonical distribution of a pair's energies at
// temperature T = 1/beta; the rate at which a ball and a piston of the gas
// exchange energy; and the static conductivity, which follows from this rate.
//
//   P(eb, ep) = beta^(3/2)/sqrt(pi ep) exp(-beta (eb + ep))               eq. canmeasure
//   <f> = beta^2/2 <(eb - ep) j> = beta^2/2 <h> = 1/sqrt(2 pi beta)       eq. nucanavg
//   exchange rate = <f> |dG_bp|/|G| = sqrt(T/(2 pi)) |dG_bp|/|G|          eq. nucanavg
//   lim delta -> 0 of exchange rate/delta^2 = sqrt(T/pi)/cell             eq. nucanavgrare
//   static conductivity = exchange rate/2                  derivation in exchange_rate.cc
//
// eb and ep are the energies of ball and piston; |dG_bp| and |G| are those of a pair.
// In a gas every piston takes area from two balls, so the exchange rate of a gas is higher: at the
// paper's rho and delta = 0.2 by 2.4 % in a chain and 4.9 % in a lattice. The difference falls as
// delta^3. The static conductivity neglects dynamic correlations: the true conductivity is a little
// lower than half of the gas's exchange rate.
//
// Units: the Boltzmann constant is 1, so T is an energy, in the units of the pair's energy. Rates
// count collisions of one contact (a ball and a piston) per unit of time. The conductivity is the
// heat current through the cross-section of one cell, divided by the temperature difference between
// neighbouring cells. The averages are in |dG_bp|/|G| times energy^(1/2) for <f>, energy^(5/2) for
// the other two. Domain: kMinTemperature <= T <= kMaxTemperature (temperature.h), kMinRho < rho <
// kMaxRho, every PairGeometry with delta > 1e-140; for smaller delta rates can underflow.
//
// Properties, each with the test that bears its name:
//   1. AccurateForEveryGeometry: relative error below kExchangeRateRelativeError.
//   2. StaticConductivityIsHalfTheExchangeRate: the energy that the kernel carries between a ball
//      and a piston of slightly different temperatures, half a cell apart, gives the static
//      conductivity.
//   3. AveragesEqualIntegralsOfTheMoments of kernel.h over the canonical density.
//
// Pure functions: safe from any thread.
#pragma once

#include "core/closed_form/pair_measures.h"
#include "core/geometry/temperature.h"  // the domain, for callers that check it

namespace ballpiston {

inline constexpr double kExchangeRateRelativeError = 6e-15;

struct CanonicalAverages {
  double mean_f;
  double mean_energy_current;  // <(eb - ep) j>
  double mean_h;
};

CanonicalAverages AveragesAt(double beta);

double ExchangeRate(const PairMeasures& measures, double temperature);

// lim delta -> 0 of ExchangeRate/delta^2.
double RareLimitExchangeRate(double rho, double temperature);

double StaticConductivity(double exchange_rate);

}  // namespace ballpiston
