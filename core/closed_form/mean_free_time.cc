#include "core/closed_form/mean_free_time.h"

namespace ballpiston {

MeanFreeTimes MeanFreeTimesFrom(const PairMeasures& m) {
  return {.ball_piston = 4 * m.volume / m.area_ball_piston,
          .ball_wall = 4 * m.volume / m.area_ball_wall,
          .piston_wall = 4 * m.volume / m.area_piston_wall};
}

MeanFreeTimes MeanFreeTimesOf(const PairGeometry& geometry) {
  return MeanFreeTimesFrom(Measures(geometry));
}

double RareLimitRate(double rho) { return 1 / (2 * std::numbers::sqrt2 * CellArea(rho)); }

double ScaledVolumeRatio(const PairGeometry& geometry) {
  // tau_bp/4 first: delta^2 alone underflows long before the ratio does.
  return geometry.delta() * (geometry.delta() * MeanFreeTimesOf(geometry).ball_piston) / 4;
}

}  // namespace ballpiston
