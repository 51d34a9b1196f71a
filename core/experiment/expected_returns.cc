#include "core/experiment/expected_returns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/closed_form/mean_free_time.h"
#include "core/closed_form/pair_measures.h"

namespace ballpiston {
namespace {

// The time of a long return if the piston is slow: its path to the far wall and back.
double PistonsRoundTrip(const PairGeometry& geometry, double epsilon) {
  return 2 * geometry.stroke() / std::sqrt(2 * epsilon);
}

// The time of a long return if the ball is slow: the mean time between its crossings of the line
// that the piston reaches, pi A/(v eta).
double BallsRoundTrip(const PairGeometry& geometry, double epsilon) {
  const PairMeasures measures = Measures(geometry);
  return std::numbers::pi * measures.cell_area / (std::sqrt(1 - 2 * epsilon) * measures.eta);
}

// The part of the mean that exceeds the mean with the slow body at rest is due to long returns.
double PerSample(double mean, double mean_at_rest, double round_trip) {
  return std::max(mean - mean_at_rest, 0.0) / round_trip;
}

// The share of the volume that one body reaches at rest, and more as it moves.
double Reached(double at_rest, double volume, double time, double round_trip) {
  const double share = at_rest / volume;
  return share + (1 - share) * std::min(time / round_trip, 1.0);
}

}  // namespace

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

double LongReturnsPerSample(const PairGeometry& geometry, double epsilon) {
  if (epsilon == 0) return 0;
  if (epsilon == 0.5) return std::numeric_limits<double>::infinity();
  const double mean = ConditionalMeanFreeTime(geometry, epsilon);
  return std::min(
      PerSample(mean, ConditionalMeanFreeTime(geometry, 0), PistonsRoundTrip(geometry, epsilon)),
      PerSample(mean, ConditionalMeanFreeTime(geometry, 0.5), BallsRoundTrip(geometry, epsilon)));
}

// The round trip of a body at rest takes for ever.
double ShareThatMeets(const PairGeometry& geometry, double epsilon, double time) {
  const RestingVolumes at_rest = VolumesAtRest(geometry);
  const double volume = Measures(geometry).volume;
  return std::min(Reached(at_rest.piston, volume, time, PistonsRoundTrip(geometry, epsilon)),
                  Reached(at_rest.ball, volume, time, BallsRoundTrip(geometry, epsilon)));
}

}  // namespace ballpiston
