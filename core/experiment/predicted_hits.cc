#include "core/experiment/predicted_hits.h"

#include <cmath>
#include <numbers>

#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/mean_free_time.h"
#include "core/closed_form/pair_measures.h"

namespace ballpiston {

PredictedHits HitsPerCollision(const PairGeometry& geometry) {
  const MeanFreeTimes tau = MeanFreeTimesOf(geometry);
  return {tau.ball_piston / tau.ball_wall, tau.ball_piston / tau.piston_wall};
}

PredictedHits HitsPerReturn(const PairGeometry& geometry, double epsilon) {
  // Rate of hits on a wall of area |dG| at fixed speed: speed/pi |dG|/|G| for the ball, whose
  // direction is uniform in its plane, and speed/2 |dG|/|G| for the piston.
  const PairMeasures measures = Measures(geometry);
  const double time = ConditionalMeanFreeTime(geometry, epsilon) / measures.volume;
  return {time * std::sqrt(1 - 2 * epsilon) * measures.area_ball_wall * std::numbers::inv_pi,
          time * std::sqrt(2 * epsilon) * measures.area_piston_wall / 2};
}

}  // namespace ballpiston
