// When a sample tells its own error: one rule for all estimates.
//
// The scatter of a sample is the error of its mean only if the sample holds what carries the mean.
// So an error is given from kEventsForAnError independent events on that carry it; the error itself
// is then known to 1/sqrt(2 kEventsForAnError) = 10 %. Which events these are, each estimate says:
//   a mean over samples             the samples
//   a mean return time              the long returns expected among them, where these are rare
//   mean sigma                      the samples of the rarer sign, and as many of the other
//   mean free times in equilibrium  a tenth of the collisions: the others follow at once
//   a correlation                   the orbits
// A quantity that cannot fluctuate has the error 0.
#ifndef BALLPISTON_CORE_STATISTICS_TOLD_ERROR_H_
#define BALLPISTON_CORE_STATISTICS_TOLD_ERROR_H_

#include <optional>

namespace ballpiston {

inline constexpr double kEventsForAnError = 50;

inline bool TellsItsError(double events) { return events >= kEventsForAnError; }

// `error`, if so many events tell it.
inline std::optional<double> ToldError(double events, std::optional<double> error) {
  return TellsItsError(events) ? error : std::nullopt;
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_STATISTICS_TOLD_ERROR_H_
