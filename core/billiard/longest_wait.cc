#include "core/billiard/longest_wait.h"

#include <cmath>
#include <numbers>

#include "core/closed_form/pair_measures.h"

namespace ballpiston {

LongestWait::LongestWait(const PairGeometry& geometry)
    : geometry_(geometry),
      memory_(1 / std::sqrt(geometry.tip())),
      round_trip_(2 * geometry.stroke()) {
  const PairMeasures measures = Measures(geometry);
  cell_area_ = measures.cell_area;
  ball_path_ = std::numbers::pi * cell_area_ / measures.eta;
  piston_path_ = round_trip_ * (1 + 3 * cell_area_ / (measures.eta * geometry.delta()));
}

double LongestWait::From(const PairState& state) const {
  const double v = state.ball_speed, u = std::fabs(state.piston_velocity);
  if (v == 0) return kLongestWait * round_trip_ / u;
  const double half = (geometry_.tip() - state.piston) / 2;
  if (half <= 0 && u == 0) return 0;
  if (half > 0) {
    const double wait = kLongestWait * memory_ * TimeToDepth(half, v);
    if (u * wait <= half) return wait;  // until then the piston remains at this depth
  }
  return kLongestWait * memory_ * (ball_path_ / v + piston_path_ / u);
}

double LongestWait::TimeToDepth(double depth, double ball_speed) const {
  return std::numbers::pi * cell_area_ / (2 * geometry_.HalfHeight(depth) * ball_speed);
}

}  // namespace ballpiston
