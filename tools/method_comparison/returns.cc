#include "tools/method_comparison/returns.h"

#include <algorithm>
#include <optional>

#include "core/closed_form/mean_free_time.h"
#include "core/experiment/expected_returns.h"
#include "server/processor_time.h"

namespace ballpiston::method_comparison {
namespace {

constexpr double kInvariantExponent = 1;

class CountedReturns : public NumberedOrbits {
 public:
  CountedReturns(const ReturnStarts& starts, const Block& block)
      : returns_(starts, block, empty_) {}

  PairState Start(uint64_t orbit) override { return returns_.Start(orbit); }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    wall_hits_ += collision.ball_wall_hits;
    return returns_.Collide(orbit, collision);
  }

  void AddTo(ReturnStatistics& statistics) {
    statistics.wall_hits += wall_hits_;
    for (uint64_t i = 0; i < returns_.count(); ++i) {
      const std::optional<Return>& hit = returns_[i].hit;
      if (!hit) continue;
      statistics.times.Add(hit->time);
      CountIngoing(*hit, statistics.ingoing);
    }
  }

 private:
  BlockResult empty_;
  BlockOrbits<ReturnOrbit, ReturnStarts> returns_;
  uint64_t wall_hits_ = 0;
};

}  // namespace

std::vector<double> IngoingProbabilities(double epsilon) {
  std::vector<double> probabilities;
  for (const std::vector<double>& bins : IngoingBinProbabilities(IngoingLaw(epsilon))) {
    probabilities.insert(probabilities.end(), bins.begin(), bins.end());
  }
  return probabilities;
}

std::vector<uint64_t> ReturnStatistics::IngoingCounts() const {
  std::vector<uint64_t> counts;
  for (const Histogram& histogram : ingoing) {
    counts.insert(counts.end(), histogram.counts.begin(), histogram.counts.end());
  }
  return counts;
}

ReturnStatistics RunReturns(const Method& method, const PairGeometry& geometry, double epsilon,
                            const RandomStream& random, uint64_t samples) {
  ReturnStatistics statistics = {.ingoing = EmptyIngoingHistograms(IngoingLaw(epsilon))};
  const ReturnStarts starts = {geometry, epsilon, kInvariantExponent, random};
  const double begin = server::ThreadSeconds();
  for (uint64_t first = 0; first < samples; first += method.together) {
    const uint64_t count = std::min(method.together, samples - first);
    CountedReturns orbits(starts, {.first = first, .samples = count});
    method.run_orbits(geometry, count, orbits, method.time_step);
    orbits.AddTo(statistics);
  }
  statistics.seconds = server::ThreadSeconds() - begin;
  return statistics;
}

double PredictedSeconds(const Method& method, const PairGeometry& geometry, double epsilon,
                        uint64_t samples) {
  const double events = method.time_step > 0
                            ? ConditionalMeanFreeTime(geometry, epsilon) / method.time_step
                            : HitsPerReturn(geometry, epsilon).Events();
  return static_cast<double>(samples) * events * method.seconds_per_event;
}

}  // namespace ballpiston::method_comparison
