// Wall hits of a ball and of a piston per unit of time at temperature 1, without ball-piston
// collisions. They predict the cost of runs, and determine how far balls fly ahead.
#pragma once

#include <cmath>
#include <numbers>

#include "core/closed_form/pair_measures.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// The mean speed of a ball at temperature 1.
inline double MeanBallSpeed() { return std::sqrt(std::numbers::pi / 2); }

struct HitRates {
  double of_a_ball;
  double of_a_piston;
};

// A piston's mean speed is sqrt(2/pi).
inline HitRates HitRatesOf(const PairGeometry& pair) {
  return {.of_a_ball = MeanBallSpeed() / MeanFlight(pair),
          .of_a_piston = std::sqrt(2 / std::numbers::pi) / pair.stroke()};
}

}  // namespace ballpiston
