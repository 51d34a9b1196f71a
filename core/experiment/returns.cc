#include "core/experiment/returns.h"

#include <algorithm>
#include <cmath>

#include "core/arithmetic/elementary_functions.h"
#include "core/sampling/collision_surface.h"
#include "core/statistics/stated_error.h"

namespace ballpiston {

PairState ReturnStarts::Draw(uint64_t sample) const {
  CounterRandom of_sample = random.Sample(sample);
  const Eigen::Vector2d ball = UniformOnCollisionSurface(geometry, of_sample);
  const SignedDirection outgoing = law.Draw(of_sample);
  return {.position = ball,
          .direction = outgoing.ball,
          .ball_speed = ball_speed,
          .piston = ball.x(),
          .piston_velocity = outgoing.sigma * piston_speed};
}

AfterCollision ReturnOrbit::Collide(const ReturnStarts&, const Collision& collision) {
  hit = {.time = collision.time,
         .direction = collision.state.direction,
         .sigma = std::signbit(collision.state.piston_velocity) ? -1 : 1};
  return AfterCollision::kEnd;
}

void ReturnOrbit::AddTo(const ReturnStarts&, BlockResult& result) const {
  if (!hit) return;
  ++result.samples;
  result.moments[0].Add(hit->time);
}

std::vector<Histogram> EmptyIngoingHistograms(const IngoingLaw& law) {
  std::vector<Histogram> histograms;
  for (const int sigma : kIngoingSigmas) {
    const double half_width = law.AlphaMax(sigma);
    if (half_width == 0) continue;
    histograms.push_back(Histogram::OfBins(-half_width, half_width, kIngoingBins));
  }
  return histograms;
}

std::vector<std::vector<double>> IngoingBinProbabilities(const IngoingLaw& law) {
  std::vector<std::vector<double>> probabilities;
  for (const Histogram& histogram : EmptyIngoingHistograms(law)) {
    const int sigma = kIngoingSigmas[probabilities.size()];
    std::vector<double>& bins = probabilities.emplace_back(kIngoingBins);
    for (size_t bin = 0; bin < kIngoingBins; ++bin) {
      bins[bin] = law.BinProbability(sigma, histogram.Edge(bin), histogram.Edge(bin + 1));
    }
  }
  return probabilities;
}

void CountIngoing(const Return& hit, std::span<Histogram> histograms) {
  // With epsilon >= 1/4 an approaching piston always moves to the left. If rounding says otherwise,
  // the hit still counts as sigma = -1.
  const size_t index = hit.sigma > 0 && histograms.size() > 1 ? 1 : 0;
  histograms[index].Add(Atan2(hit.direction.y(), hit.direction.x()));
}

Histogram EmptyReturnTimes(double mean) {
  return Histogram::OfBins(0, WithoutLastBits(kReturnTimeMeans * mean), kReturnTimeBins);
}

Curve SurvivalCurve(const Histogram& return_times, double mean, double events_per_sample) {
  Curve curve = {.name = "survival"};
  const auto samples = static_cast<double>(return_times.Total());
  if (samples == 0) return curve;
  double later = samples;
  for (size_t bin = 0; bin < kReturnTimeBins; ++bin) {
    const double share = later / samples;
    const double limit = std::exp(-return_times.Edge(bin) / mean);
    const double events = samples * std::min(limit * (1 - limit), events_per_sample);
    // Half a count more: a share of 0 or 1 among few long returns is not exact.
    const double expected = (later + 0.5) / (samples + 1);
    const double error = std::sqrt(expected * (1 - expected) / samples);
    curve.points.push_back({.at = return_times.Edge(bin),
                            .value = share,
                            .standard_error = bin == 0 ? 0 : StatedError(events, share, error),
                            .limit = limit});
    later -= static_cast<double>(return_times.counts[bin]);
  }
  return curve;
}

}  // namespace ballpiston
