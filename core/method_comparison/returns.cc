#include "core/method_comparison/returns.h"

#include <algorithm>

#include "core/closed_form/conditional_rate.h"
#include "core/experiment/predicted_hits.h"
#include "core/experiment/return_orbits.h"
#include "core/method_comparison/method_orbits.h"
#include "core/method_comparison/processor_time.h"

namespace ballpiston {
namespace {

constexpr double kInvariantExponent = 1;

// Returns between looks at `stop`. In lanes so many that these are full but for the last few, and
// few enough for memory.
uint64_t BatchSize(Method method) {
  return method == Method::kLanes || method == Method::kLanesSingle ? 1 << 17 : 1 << 8;
}

class CountedReturns : public ReturnOrbits {
 public:
  using ReturnOrbits::ReturnOrbits;

  AfterContact Meet(uint64_t orbit, const Contact& contact) override {
    wall_hits_ += contact.ball_wall_hits;
    return ReturnOrbits::Meet(orbit, contact);
  }
  uint64_t wall_hits() const { return wall_hits_; }

 private:
  uint64_t wall_hits_ = 0;
};

void Add(const CountedReturns& orbits, ReturnStatistics* statistics) {
  statistics->wall_hits += orbits.wall_hits();
  for (const Return& hit : orbits.returns()) {
    if (hit.escaped) continue;
    statistics->times.Add(hit.time);
    statistics->ingoing.Add(hit);
  }
}

// Of one event, or one time step.
double PredictedSecondsPerEvent(Method method) {
  switch (method) {
    case Method::kFixedStep:
      return 3e-9;
    case Method::kReferenceSingle:
    case Method::kReference:
      return 4e-8;
    case Method::kReferenceLongDouble:
      return 1e-7;
    case Method::kReferenceQuadruple:
      return 3e-6;
    case Method::kLanes:
    case Method::kLanesSingle:
      return 4e-9;
    case Method::kClosedForm:
    case Method::kMarkov:
    case Method::kSpectrum:
      break;
  }
  return 0;
}

}  // namespace

std::optional<ReturnStatistics> RunReturns(const MethodVariant& variant,
                                           const PairGeometry& geometry, double epsilon,
                                           const RandomStream& random, uint64_t samples,
                                           const std::stop_token& stop) {
  ReturnStatistics statistics = {.times = {}, .ingoing = IngoingCounts(epsilon)};
  const double begin = ThreadSeconds();
  const uint64_t batch = BatchSize(variant.method);
  for (uint64_t first = 0; first < samples; first += batch) {
    if (stop.stop_requested()) return std::nullopt;
    const uint64_t count = std::min(batch, samples - first);
    CountedReturns orbits(geometry, {epsilon, kInvariantExponent}, random, first, count);
    if (!RunMethodOrbits(variant, geometry, count, orbits, stop)) return std::nullopt;
    Add(orbits, &statistics);
  }
  statistics.seconds = ThreadSeconds() - begin;
  return statistics;
}

double PredictedSeconds(const MethodVariant& variant, const PairGeometry& geometry, double epsilon,
                        uint64_t samples) {
  const double events = variant.method == Method::kFixedStep
                            ? ConditionalMeanFreeTime(geometry, epsilon) / variant.time_step
                            : HitsPerReturn(geometry, epsilon).Events();
  return static_cast<double>(samples) * events * PredictedSecondsPerEvent(variant.method);
}

}  // namespace ballpiston
