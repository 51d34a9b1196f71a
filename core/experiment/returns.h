// Returns to the collision surface at fixed energies. An orbit starts uniformly on dGamma_bp with
// an outgoing law and ends at the next ball-piston collision. The ingoing velocities are recorded
// before the exchange. Each orbit is one sample of first-hit and of conditional-mean-free-time.
//
// The ingoing law of eq. kld has cells: bins of alpha over the interval that is permitted for each
// sign of the piston's velocity. sigma = -1 comes first, then +1, which occurs only for
// epsilon < 1/4.
//
// In the limit delta -> 0 the law of return times is expected to become exponential with the rate
// of eq. fmftbpeprate. Times are counted in kReturnTimeBins bins, each a tenth of the mean return
// time at this energy; later returns count in the last bin. The curve `survival` shows the law: the
// probability that ball and piston have not collided up to a time.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/closed_form/ingoing_law.h"
#include "core/ensemble/block_orbits.h"
#include "core/ensemble/point_summary.h"
#include "core/ensemble/random_stream.h"
#include "core/geometry/pair_geometry.h"
#include "core/sampling/outgoing_law.h"
#include "core/statistics/histogram.h"

namespace ballpiston {

struct Return {
  double time = 0;
  Eigen::Vector2d direction = {0, 0};  // of the ball, ingoing: (cos alpha, sin alpha)
  int sigma = 0;                       // sign of the piston's velocity, ingoing
};

// Draws the starts of a point's returns.
struct ReturnStarts {
  PairGeometry geometry;
  double epsilon;
  double exponent;
  RandomStream random;
  OutgoingLaw law = {epsilon, exponent};
  double ball_speed = std::sqrt(1 - 2 * epsilon);
  double piston_speed = std::sqrt(2 * epsilon);

  PairState Draw(uint64_t sample) const;
};

// An orbit of a block's returns.
struct ReturnOrbit {
  std::optional<Return> hit;  // empty if the orbit has not ended, or has escaped

  static uint64_t LengthIn(const Block&) { return 1; }
  PairState Start(const ReturnStarts& starts, const OrbitSamples& samples) const {
    return starts.Draw(samples.first);
  }
  AfterCollision Collide(const ReturnStarts&, const Collision& collision);
  // Adds the sample and its time, which is the first of the moments.
  void AddTo(const ReturnStarts&, BlockResult& result) const;
};

inline constexpr size_t kIngoingBins = 1000;                   // of each sigma
inline constexpr std::array<int, 2> kIngoingSigmas = {-1, 1};  // by index of the histogram

std::vector<Histogram> EmptyIngoingHistograms(const IngoingLaw& law);

// Exact probabilities of each histogram's bins.
std::vector<std::vector<double>> IngoingBinProbabilities(const IngoingLaw& law);

void CountIngoing(const Return& hit, std::span<Histogram> histograms);

inline constexpr size_t kReturnTimeBins = 80;
inline constexpr double kReturnTimeMeans = 8;  // upper end of the bins, in mean return times

// `mean`: the mean return time at this energy.
Histogram EmptyReturnTimes(double mean);

// The points are at the lower edges of the bins. The limit is the exponential law of this mean. The
// errors are binomial; a point has one if enough earlier and later returns are expected in the
// limit, and enough events of the mean time.
Curve SurvivalCurve(const Histogram& return_times, double mean, double events_per_sample = 1);

}  // namespace ballpiston
