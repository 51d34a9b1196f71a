// Gases for tests. Their parameters must be valid.
#pragma once

#include "core/gas/canonical_gas.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_shape.h"
#include "core/gas/gas_state.h"
#include "tests/core/preamble.h"

namespace ballpiston {

inline GasShape ShapeNamed(absl::string_view text) { return ParseGasShape(text).value(); }

inline GasGeometry GasOf(double rho, double delta, absl::string_view shape,
                         GasEnds ends = GasEnds::kPeriodic) {
  return GasGeometry::Create(rho, delta, ShapeNamed(shape), ends).value();
}

// delta is `share` times its bound.
inline GasGeometry GasAtShare(double rho, double share, absl::string_view shape,
                              GasEnds ends = GasEnds::kPeriodic) {
  return GasOf(rho, share * GasDeltaBound(rho), shape, ends);
}

inline GasState GasInEquilibrium(const GasGeometry& geometry, double temperature, uint64_t seed,
                                 uint64_t sample) {
  CounterRandom random(seed, 0, sample);
  return DrawGas(geometry, TemperatureProfile(temperature), random);
}

// All bodies in the middle of their places.
inline GasState AtRest(const GasGeometry& geometry) {
  GasState state;
  state.balls.resize(static_cast<size_t>(geometry.balls()));
  state.pistons.resize(static_cast<size_t>(geometry.pistons()));
  return state;
}

// All positions and velocities, in the order of a tangent vector's components.
inline Eigen::VectorXd ComponentsOf(const GasState& state) {
  std::vector<double> components;
  for (const GasBall& ball : state.balls) {
    const Eigen::Vector2d velocity = ball.speed * ball.direction;
    components.insert(components.end(),
                      {ball.position.x(), ball.position.y(), velocity.x(), velocity.y()});
  }
  for (const GasPiston& piston : state.pistons) {
    components.insert(components.end(), {piston.offset, piston.velocity});
  }
  return Eigen::Map<Eigen::VectorXd>(components.data(), std::ssize(components));
}

// The distance from the ball to the piston that it sees in this direction; negative if the ball is
// beyond the piston.
inline double GapTo(const GasGeometry& geometry, const GasState& state, int64_t ball,
                    Direction direction) {
  const auto& position = state.balls[static_cast<size_t>(ball)].position;
  const auto piston = static_cast<size_t>(geometry.PistonOf(ball, direction));
  return 0.5 + SignOf(direction) * state.pistons[piston].offset -
         SeenToward(direction, position).x();
}

}  // namespace ballpiston
