#include "tools/stability/pair_starts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/billiard/event_flow.h"
#include "core/geometry/cell_profile.h"
#include "core/sampling/collision_surface.h"
#include "core/sampling/direction.h"

namespace ballpiston::stability {
namespace {

using Eigen::Vector2d;

constexpr int kWallHitsBefore = 3;

void Reverse(PairState& state) {
  state.direction = -state.direction;
  state.piston_velocity = -state.piston_velocity;
}

// The state of the pair some wall hits earlier; empty if ball and piston collided in between.
std::optional<PairState> Before(const PairGeometry& geometry, PairState state) {
  Reverse(state);
  ReferenceFlow flow(geometry, state);
  for (int hits = 0; hits < kWallHitsBefore;) {
    const EventKind kind = flow.Step().kind;
    if (kind == EventKind::kBallPiston || kind == EventKind::kEscape) return std::nullopt;
    hits += kind == EventKind::kBallWall;
  }
  // Continue for half a flight: on a wall it would be unclear whether the wall has already been
  // hit.
  state = flow.state();
  const double half = flow.Step().duration / 2;
  state.position += state.direction * (state.ball_speed * half);
  state.piston += state.piston_velocity * half;
  Reverse(state);
  if (state.position.x() > state.piston) return std::nullopt;
  return state;
}

// Velocities uniform on the unit sphere: ball and piston of all speeds.
PairState WithAnyVelocities(const Vector2d& position, double piston, CounterRandom& random) {
  const double v3 = 2 * random.Uniform() - 1;
  return {.position = position,
          .direction = UniformDirection(random),
          .ball_speed = std::sqrt((1 - v3) * (1 + v3)),
          .piston = piston,
          .piston_velocity = v3};
}

// A point of the upper or the lower arc that the piston can reach.
Vector2d PistonsEdge(const PairGeometry& geometry, CounterRandom& random) {
  const double depth = geometry.delta() * random.Uniform();
  const double side = (random.Bits() & 1) != 0 ? 1 : -1;
  return {geometry.tip() - depth, side * HalfHeight(geometry.lambda(), depth)};
}

double Clamped(const PairGeometry& geometry, double piston) {
  return std::clamp(piston, geometry.piston_left(), geometry.piston_right());
}

// Calls `aim` for a state in the target situation until a state has an earlier state.
template <typename Aim>
PairState Backwards(const PairGeometry& geometry, const Aim& aim) {
  for (;;) {
    const PairState state = aim();
    const double approach = state.ball_speed * state.direction.x() - state.piston_velocity;
    if (approach <= 0) continue;
    if (const auto before = Before(geometry, state)) return *before;
  }
}

// Reverses the ball if it does not move towards the wall of its quadrant.
void TurnToWall(PairState& state) {
  const Vector2d centre = {0.5, std::copysign(0.5, state.position.y())};
  if (state.direction.dot(state.position - centre) > 0) state.direction = -state.direction;
}

// A state just after a collision on the surface, with the given speeds; ball and piston separate.
PairState JustAfterCollision(const PairGeometry& geometry, double ball, double piston,
                             CounterRandom& random) {
  const Vector2d position = UniformOnCollisionSurface(geometry, random);
  PairState state = {.position = position,
                     .direction = UniformDirection(random),
                     .ball_speed = ball,
                     .piston = position.x(),
                     .piston_velocity = piston};
  if (ball * state.direction.x() > piston) state.direction.x() = -state.direction.x();
  return state;
}

}  // namespace

PairState AimedAtPistonsEdge(const PairGeometry& geometry, CounterRandom& random) {
  return Backwards(geometry, [&] {
    const Vector2d edge = PistonsEdge(geometry, random);
    PairState state =
        WithAnyVelocities(edge, Clamped(geometry, edge.x() + RandomOffset(random)), random);
    TurnToWall(state);
    return state;
  });
}

PairState AimedAtPistonsTurn(const PairGeometry& geometry, CounterRandom& random) {
  return Backwards(geometry, [&] {
    const double height = HalfHeight(geometry.lambda(), geometry.delta());
    const Vector2d position = {geometry.piston_left() + RandomOffset(random) * geometry.delta(),
                               0.99 * height * (2 * random.Uniform() - 1)};
    return WithAnyVelocities(position, geometry.piston_left(), random);
  });
}

PairState AimedAtTipAndPiston(const PairGeometry& geometry, CounterRandom& random) {
  return Backwards(geometry, [&] {
    const Vector2d tip = {geometry.tip(), 0};
    PairState state =
        WithAnyVelocities(tip, Clamped(geometry, tip.x() + RandomOffset(random)), random);
    const double slope = geometry.lambda() * (2 * random.Uniform() - 1);
    state.direction = Vector2d(1, slope + RandomOffset(random)).normalized();
    return state;
  });
}

PairState AimedAtPiston(const PairGeometry& geometry, CounterRandom& random) {
  return Backwards(geometry, [&] {
    const Vector2d position = UniformOnCollisionSurface(geometry, random);
    PairState state = WithAnyVelocities(position, position.x(), random);
    // From a point so near the tip, the rest of the cell is in directions near the axis.
    state.direction = Vector2d(1, geometry.lambda() * (2 * random.Uniform() - 1)).normalized();
    return state;
  });
}

PairState InTheWedge(const PairGeometry& geometry, CounterRandom& random) {
  for (;;) {
    const Vector2d edge = PistonsEdge(geometry, random);
    const double inward = std::fabs(RandomOffset(random)), gap = std::fabs(RandomOffset(random));
    const Vector2d position = {edge.x(), edge.y() * (1 - inward)};
    const PairState state = WithAnyVelocities(position, Clamped(geometry, edge.x() + gap), random);
    if (state.piston >= position.x()) return state;
  }
}

PairState SlowBall(const PairGeometry& geometry, CounterRandom& random) {
  const double energy = std::fabs(RandomOffset(random));
  return JustAfterCollision(geometry, std::sqrt(energy), std::sqrt(1 - energy), random);
}

PairState SlowPiston(const PairGeometry& geometry, CounterRandom& random) {
  const double offset = RandomOffset(random), energy = std::fabs(offset);
  return JustAfterCollision(geometry, std::sqrt(1 - energy),
                            std::copysign(std::sqrt(energy), offset), random);
}

}  // namespace ballpiston::stability
