#include "core/closed_form/mean_free_time.h"

#include <numbers>

#include "core/closed_form/kernel.h"

namespace ballpiston {
namespace {

double VisitedVolume(const PairGeometry& geometry, double ep) {
  if (ep == 0) return VolumesAtRest(geometry).piston;
  if (ep == 0.5) return VolumesAtRest(geometry).ball;
  return Measures(geometry).volume;
}

}  // namespace

MeanFreeTimes MeanFreeTimesFrom(const PairMeasures& m) {
  return {.ball_piston = 4 * m.volume / m.area_ball_piston,
          .ball_wall = 4 * m.volume / m.area_ball_wall,
          .piston_wall = 4 * m.volume / m.area_piston_wall};
}

MeanFreeTimes MeanFreeTimesOf(const PairGeometry& geometry) {
  return MeanFreeTimesFrom(Measures(geometry));
}

// nu_bp(ep) = f |dG_bp|/|G| and tau_bp = 4 |G|/|dG_bp|.
double Phi(double ep) { return 4 * PairCollisionRate(ep); }

double ConditionalMeanFreeTime(const PairGeometry& geometry, double ep) {
  return 4 * VisitedVolume(geometry, ep) / (Measures(geometry).area_ball_piston * Phi(ep));
}

double RareLimitRate(double rho) { return 1 / (2 * std::numbers::sqrt2 * CellArea(rho)); }

}  // namespace ballpiston
