// The rule that decides whether an estimate gets a standard error. It is the same for all
// estimates.
//
// The scatter of a sample is the error of its mean only if the sample contains the events that
// determine the mean. An error is given if there are at least kEventsForAnError independent events
// of this kind. Its own relative error is then 1/sqrt(2 kEventsForAnError) = 10 %. The events are:
//   mean over samples               the samples
//   mean return time                the expected number of long returns, where these are rare
//   mean sigma                      N (1 - mean^2): some four times the samples of the rarer sign
//   mean free times in equilibrium  a tenth of the collisions (experiment/equilibrium.cc)
//   correlation                     the orbits
// A quantity that cannot fluctuate has the error 0.
#ifndef BALLPISTON_CORE_STATISTICS_TOLD_ERROR_H_
#define BALLPISTON_CORE_STATISTICS_TOLD_ERROR_H_

#include <optional>

namespace ballpiston {

inline constexpr double kEventsForAnError = 50;

inline bool TellsItsError(double events) { return events >= kEventsForAnError; }

// `error`, if this number of events is enough for an error.
inline std::optional<double> ToldError(double events, std::optional<double> error) {
  return TellsItsError(events) ? error : std::nullopt;
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_STATISTICS_TOLD_ERROR_H_
