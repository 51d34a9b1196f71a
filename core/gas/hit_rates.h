// How often balls and pistons hit their walls at temperature 1, as if no ball met a piston: what
// runs will cost, and how far balls may fly ahead. Hits in a unit of time.
#ifndef BALLPISTON_CORE_GAS_HIT_RATES_H_
#define BALLPISTON_CORE_GAS_HIT_RATES_H_

#include <cmath>
#include <numbers>

#include "core/closed_form/pair_measures.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

struct HitRates {
  double of_a_ball;
  double of_a_piston;
};

// A ball's mean speed is sqrt(pi/2), and its mean flight pi area/perimeter of its cell. A piston's
// mean speed is sqrt(2/pi).
inline HitRates HitRatesOf(const PairGeometry& pair) {
  const PairMeasures measures = Measures(pair);
  const double flight =
      std::numbers::pi * measures.cell_area * pair.stroke() / measures.area_ball_wall;
  return {.of_a_ball = std::sqrt(std::numbers::pi / 2) / flight,
          .of_a_piston = std::sqrt(2 / std::numbers::pi) / pair.stroke()};
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_GAS_HIT_RATES_H_
