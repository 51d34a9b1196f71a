#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>

#include "core/closed_form/pair_measures.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/reference_gas.h"
#include "core/gas/thermal_walls.h"
#include "core/sampling/direction.h"
#include "tools/stability/starts.h"

namespace ballpiston::stability {
namespace {

GasState AllAtRest(const GasGeometry& geometry) {
  GasState state;
  state.balls.resize(static_cast<size_t>(geometry.balls()));
  state.pistons.resize(static_cast<size_t>(geometry.pistons()));
  return state;
}

// Multiplies all velocities by `factor`.
void Scale(double factor, GasState& state) {
  for (GasBall& ball : state.balls) ball.speed *= factor;
  for (GasPiston& piston : state.pistons) piston.velocity *= factor;
}

double LargestSpeed(const GasState& state) {
  double largest = 0;
  for (const GasBall& ball : state.balls) largest = std::max(largest, ball.speed);
  for (const GasPiston& p : state.pistons) largest = std::max(largest, std::fabs(p.velocity));
  return largest;
}

// A gas from AnyGas in which `energy` draws the energy of each body.
template <typename DrawEnergy>
GasState WithEnergies(const GasGeometry& geometry, CounterRandom& random,
                      const DrawEnergy& energy) {
  GasState state = AnyGas(geometry, random);
  for (GasBall& ball : state.balls) ball.speed = std::sqrt(energy());
  for (GasPiston& piston : state.pistons) {
    piston.velocity = std::copysign(std::sqrt(energy()), piston.velocity);
  }
  return state;
}

GasState NearlyAtRest(const GasGeometry& geometry, CounterRandom& random) {
  return WithEnergies(geometry, random, [&] { return std::fabs(RandomOffset(random)); });
}

size_t AnyOf(size_t count, CounterRandom& random) {
  return static_cast<size_t>(random.Uniform() * static_cast<double>(count));
}

Direction AnyDirection(const GasGeometry& geometry, CounterRandom& random) {
  return geometry.DirectionAt(
      static_cast<int>(AnyOf(static_cast<size_t>(geometry.directions()), random)));
}

// Whether each ball is on its own side of its pistons.
bool IsPossible(const GasGeometry& geometry, const GasState& state) {
  for (int64_t ball = 0; ball < geometry.balls(); ++ball) {
    const Eigen::Vector2d& position = state.balls[static_cast<size_t>(ball)].position;
    for (int i = 0; i < geometry.directions(); ++i) {
      const Direction direction = geometry.DirectionAt(i);
      const auto piston = static_cast<size_t>(geometry.PistonOf(ball, direction));
      const double place = 0.5 + SignOf(direction) * state.pistons[piston].offset;
      if (SeenToward(direction, position).x() > place) return false;
    }
  }
  return true;
}

GasState WithReversedVelocities(GasState state) {
  for (GasBall& ball : state.balls) ball.direction = -ball.direction;
  for (GasPiston& piston : state.pistons) piston.velocity = -piston.velocity;
  return state;
}

// The state of the gas some flights earlier.
GasState EarlierBy(double flights, const GasGeometry& geometry, GasState state) {
  ReferenceGas gas(geometry, WithReversedVelocities(std::move(state)), ThermalWalls());
  const double time = flights * MeanFlight(geometry.pair());
  while (gas.NextTime() <= time) gas.Step();
  return WithReversedVelocities(gas.StateAt(time));
}

// Moves the piston in this direction to its innermost position in the cell, on its way inward.
void BringPiston(const GasGeometry& geometry, Direction direction, CounterRandom& random,
                 GasState& state) {
  const double left = std::fabs(RandomOffset(random)), sign = SignOf(direction);
  state.pistons[static_cast<size_t>(geometry.PistonOf(0, direction))] = {
      .offset = sign * (left - geometry.reach()), .velocity = -sign * random.Uniform()};
}

}  // namespace

GasState AnyGas(const GasGeometry& geometry, CounterRandom& random) {
  GasState state = DrawGas(geometry, TemperatureProfile(1), random);
  Scale(1 / LargestSpeed(state), state);
  return state;
}

GasState OneHotBall(const GasGeometry& geometry, CounterRandom& random) {
  GasState state = NearlyAtRest(geometry, random);
  state.balls[AnyOf(state.balls.size(), random)].speed = 1;
  return state;
}

GasState OneHotPiston(const GasGeometry& geometry, CounterRandom& random) {
  GasState state = NearlyAtRest(geometry, random);
  state.pistons[AnyOf(state.pistons.size(), random)].velocity = 1;
  return state;
}

GasState AnyEnergies(const GasGeometry& geometry, CounterRandom& random) {
  return WithEnergies(geometry, random, [&] { return std::pow(10, -17 * random.Uniform()); });
}

GasState AimedAtTwoPistons(const GasGeometry& geometry, CounterRandom& random) {
  for (;;) {
    GasState state = AllAtRest(geometry);
    const double depth = geometry.pair().rho() + std::fabs(RandomOffset(random));
    const double x = 0.5 - depth * (std::numbers::sqrt2 / 2);
    GasBall& ball = state.balls[0];
    ball = {.position = {x, x}, .direction = UniformDirection(random)};
    if (ball.direction.sum() < 0) ball.direction = -ball.direction;  // toward the wall
    ball.speed = 0.3 + 0.7 * random.Uniform();
    BringPiston(geometry, Direction::kRight, random, state);
    BringPiston(geometry, Direction::kUp, random, state);
    if (!IsPossible(geometry, state)) continue;
    state = EarlierBy(2, geometry, state);
    if (IsPossible(geometry, state)) return state;
  }
}

// A slow ball would reach the target late, after rounding errors have grown.
GasState WithPair(DrawStart& draw, const GasGeometry& geometry, CounterRandom& random) {
  constexpr double kSlow = 0.4;
  for (;;) {
    const PairState pair = draw(geometry.pair(), random);
    const int64_t ball = static_cast<int64_t>(AnyOf(static_cast<size_t>(geometry.balls()), random));
    const Direction direction = AnyDirection(geometry, random);
    if (pair.ball_speed < kSlow) continue;
    GasState state = AllAtRest(geometry);
    state.balls[static_cast<size_t>(ball)] = {.position = SeenFrom(direction, pair.position),
                                              .direction = SeenFrom(direction, pair.direction),
                                              .speed = pair.ball_speed};
    const double sign = SignOf(direction);
    state.pistons[static_cast<size_t>(geometry.PistonOf(ball, direction))] = {
        .offset = sign * (pair.piston - 0.5), .velocity = sign * pair.piston_velocity};
    if (IsPossible(geometry, state)) return state;
  }
}

}  // namespace ballpiston::stability
