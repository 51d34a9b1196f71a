// The constants of flights and of the piston's reach, in the units of the lanes. lane_flight-inl.h
// derives the formulas of a flight, lane_burst-inl.h those of the reach. The lanes of a processor
// and of a device (core/gpu) use the same constants.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/billiard/piston_wave.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

template <typename T>
struct FlightConstants {
  explicit FlightConstants(const PairGeometry& geometry)
      : scale(M_SQRT2 / geometry.rho()),
        sqrt_2(static_cast<T>(M_SQRT2)),
        half_height(static_cast<T>(scale * scale / 2)),
        length_squared(static_cast<T>(1 / (scale * scale))),
        tip(static_cast<T>(0.5 - geometry.lambda() / 2)) {}

  double scale;  // of h, e, c, s and lengths in lanes
  T sqrt_2;      // rho
  T half_height;
  T length_squared;
  T tip;  // from the cell's centre
};

inline constexpr size_t kMostFlights = 12;  // of a lane in a burst

// The flights of an orbit's burst in the engine of the pair. A lane that has a collision flies on
// to the end of the burst, and those flights are lost. So a burst is short where collisions are
// frequent.
inline size_t FlightsInABurst(const PairGeometry& geometry) {
  return static_cast<size_t>(std::clamp(1.7 / geometry.delta(), 4.0, double{kMostFlights}));
}

// Rounding in the lanes must not hide a collision; a false alarm costs little.
template <typename T>
inline constexpr double kSlack = sizeof(T) == 8 ? 1e-11 : 1e-3;

// The largest c'^2 - 2 that counts as a rounding error. Rounding causes a few ulps.
template <typename T>
inline constexpr T kMissedByRounding = sizeof(T) == 8 ? T(1e-12) : T(1e-5);

// The piston's reach and its wave, in the lanes' units. x of a ball is in squared units.
template <typename T>
struct ReachConstants {
  ReachConstants(const PairGeometry& geometry, double scale) {
    const PistonWave wave(geometry);
    const double square = scale * scale, stroke = wave.stroke();
    left = static_cast<T>(square * (wave.left() - kSlack<T>));
    period = static_cast<T>(square * 2 * stroke);
    phase_at_tip = static_cast<T>((geometry.delta() + 2 * kSlack<T>) / (2 * stroke));
    // The arc with the right tip is x = 1/2 + rho sin(angle - 45 degrees), up to 45 degrees.
    const double sine = std::max((wave.left() - kSlack<T> - 0.5) / geometry.rho(), -1.0);
    edge = static_cast<T>(scale * std::sin(std::asin(sine) + M_PI_4));
  }
  T left;    // from this x on the piston can reach the ball
  T period;  // of the piston, as a length
  T phase_at_tip;
  // The place on an arc from which the piston at the arc's tip can reach the arc. Places are
  // measured along the arc from its middle: (q_x - q_y)/2.
  T edge;
};

}  // namespace ballpiston
