// The rule that decides whether the mean over a sample gets a standard error. Other estimates have
// rules of their own: closed forms, the spectrum and divergences always have an error; time
// averages of gas-conduction have one as soon as seven eighths of the groups of trajectories have
// been measured (experiment/steady_gas.cc), because each trajectory has many events; and cumulants
// from enough windows on (experiment/gas_conduction.cc).
//
// The scatter of a sample is the error of its mean only if the sample contains the events that
// determine the mean. An error is given if there are at least kEventsForAnError independent events
// of this kind. Its own relative error is then 1/sqrt(2 kEventsForAnError) = 10 %. The events are:
//   mean over samples               the samples
//   coefficient of variation        a twentieth of these (experiment/first_hit.cc)
//   mean return time                the expected number of long returns, where these are rare
//   survival                        the expected earlier or later returns, at most
//                                   those of the mean return time
//   mean cos alpha                  the samples, or fewer (experiment/first_hit.cc)
//   mean sigma                      the expected samples of the rarer sign, or fewer (likewise)
//   mean free times in equilibrium  a tenth of the collisions (experiment/equilibrium.cc)
//   relaxation of an energy         the expected number of orbits that meet; without an epsilon an
//                                   eighth of the orbits (experiment/energy_relaxation.cc)
//   mean energy at a time           at most the orbits that can have met by then
//   a gas's current, by exchanges   a tenth of the replicas, or less (gas_equilibrium.cc)
//   Markov property                 the orbits
//   Lyapunov exponents              the orbits
// The number of events is an expected one, never a measured one: an error that is shown only if the
// sample happens to contain many events is shown for samples that lie to one side. A quantity that
// cannot fluctuate has the error 0.
#pragma once

#include <cmath>
#include <optional>

namespace ballpiston {

inline constexpr double kEventsForAnError = 50;

// The rounding of a mean, relative. A running mean over a block of 65,536 samples (Moments::Add)
// ignores deviations that change it by less than half an ulp. If the samples differ by that little,
// the mean is off by up to some 300 ulps. A smaller scatter is not the error of the mean.
inline constexpr double kRoundingOfAMean = 3e-14;

inline bool HasStatedError(double events) { return events >= kEventsForAnError; }

// `error` of the mean `value`, at least the relative `rounding`, if this number of events is
// enough.
inline std::optional<double> StatedError(double events, double value, std::optional<double> error,
                                         double rounding = kRoundingOfAMean) {
  if (!error || !HasStatedError(events)) return std::nullopt;
  return std::fmax(*error, rounding * std::fabs(value));
}

}  // namespace ballpiston
