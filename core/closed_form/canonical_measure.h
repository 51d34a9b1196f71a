// The canonical distribution of a pair's energies, and the averages of the kernel's moments.
//
//   P(eb, ep) = beta^(3/2)/sqrt(pi ep) exp(-beta (eb + ep))               eq. canmeasure
//   <f> = beta^2/2 <(eb - ep) j> = beta^2/2 <h> = 1/sqrt(2 pi beta)       eq. nucanavg
//
// Symbols: beta inverse temperature; eb, ep energies of ball and piston (a Gamma(1) and a
// Gamma(1/2) variable). Units: P per energy^2; averages in |dG_bp|/|G| times energy^(1/2) for <f>,
// energy^(5/2) for the other two. Domain of P: beta > 0, eb >= 0, ep >= 0 (P is infinite at
// ep = 0). Domain of the averages: kMinTemperature <= beta <= kMaxTemperature, and the same for
// 1/beta (core/geometry/temperature.h); there <h>, which grows as T^(5/2), stays in the range of
// double.
//
// Properties, each with the test that bears its name:
//   1. AveragesEqualIntegralsOfTheMoments: integrals of kernel_moments.h over P.
//
// Pure functions: safe from any thread.
#pragma once

#include "core/geometry/temperature.h"  // the domain, for callers that check it

namespace ballpiston {

double CanonicalDensity(double beta, double eb, double ep);

struct CanonicalAverages {
  double mean_f;
  double mean_energy_current;  // <(eb - ep) j>
  double mean_h;
};

CanonicalAverages AveragesAt(double beta);

}  // namespace ballpiston
