// The unit of time of the gases: the mean flight of a ball of speed 1 between two walls.
#ifndef BALLPISTON_TOOLS_STABILITY_GAS_FLIGHTS_H_
#define BALLPISTON_TOOLS_STABILITY_GAS_FLIGHTS_H_

#include <cmath>
#include <numbers>

#include "core/gas/hit_rates.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston::stability {

inline double MeanFlight(const PairGeometry& geometry) {
  const double mean_speed = std::sqrt(std::numbers::pi / 2);  // of a ball at temperature 1
  return mean_speed / HitRatesOf(geometry).of_a_ball;
}

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_GAS_FLIGHTS_H_
