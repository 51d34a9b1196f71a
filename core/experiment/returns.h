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
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/closed_form/ingoing_law.h"
#include "core/ensemble/chunk_plan.h"
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

struct ReturnLaw {
  double epsilon;
  double exponent;
};

// The returns of one block.
class ReturnOrbits {
 public:
  ReturnOrbits(const PairGeometry& geometry, const ReturnLaw& law, const RandomStream& random,
               const Block& block);

  uint64_t count() const { return returns_.size(); }
  PairState Start(uint64_t orbit);
  AfterCollision Collide(uint64_t orbit, const Collision& collision);  // not for an escape

  // In the order of samples; empty for an orbit that has not ended, or has escaped.
  const std::vector<std::optional<Return>>& returns() const { return returns_; }

 private:
  PairGeometry geometry_;
  OutgoingLaw law_;
  double ball_speed_;
  double piston_speed_;
  RandomStream random_;
  uint64_t first_;
  std::vector<std::optional<Return>> returns_;
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

// The points are at the lower edges of the bins. The errors are binomial; a point has one if
// enough earlier and later returns are expected in the limit.
Curve SurvivalCurve(const Histogram& return_times);

}  // namespace ballpiston
