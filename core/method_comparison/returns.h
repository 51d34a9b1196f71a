// Returns to the collision surface at fixed energies from the invariant law, by any of the methods:
// their times, their ingoing angles, and what they cost.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_RETURNS_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_RETURNS_H_

#include <cstdint>
#include <optional>
#include <stop_token>

#include "core/experiment/random_stream.h"
#include "core/geometry/pair_geometry.h"
#include "core/method_comparison/ingoing_divergence.h"
#include "core/method_comparison/method.h"
#include "core/statistics/moments.h"

namespace ballpiston {

// Of the orbits that were not lost.
struct ReturnStatistics {
  Moments times;
  IngoingCounts ingoing;
  uint64_t wall_hits = 0;  // the ball's
  double seconds = 0;      // of processor time
};

// Samples 0 ... samples - 1 of the stream. Empty if `stop` came before the end. Not for
// kClosedForm, kMarkov, kSpectrum.
std::optional<ReturnStatistics> RunReturns(const MethodVariant& variant,
                                           const PairGeometry& geometry, double epsilon,
                                           const RandomStream& random, uint64_t samples,
                                           const std::stop_token& stop);

// What so many would cost, on a processor of 3 GHz or so, within a factor of three.
double PredictedSeconds(const MethodVariant& variant, const PairGeometry& geometry, double epsilon,
                        uint64_t samples);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_RETURNS_H_
