#include "core/gas/canonical_gas.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/geometry/pair_state.h"
#include "core/sampling/direction.h"

namespace ballpiston {
namespace {

struct Contact {
  int64_t ball;
  Direction direction;
};

// ---- places ----

void DrawPlace(const GasGeometry& geometry, CounterRandom& random, GasBall& ball) {
  const double half_width = geometry.pair().tip();
  do {
    const double x = (2 * random.Uniform() - 1) * half_width;
    ball.position = {x, (2 * random.Uniform() - 1) * half_width};
  } while (!InsideCell(geometry.pair(), ball.position));
}

void DrawPlace(const GasGeometry& geometry, CounterRandom& random, GasPiston& piston) {
  piston.offset = (2 * random.Uniform() - 1) * geometry.reach();
}

GasState DrawPlaces(const GasGeometry& geometry, CounterRandom& random) {
  GasState state;
  state.balls.resize(static_cast<size_t>(geometry.balls()));
  state.pistons.resize(static_cast<size_t>(geometry.pistons()));
  for (GasBall& ball : state.balls) DrawPlace(geometry, random, ball);
  for (GasPiston& piston : state.pistons) DrawPlace(geometry, random, piston);
  return state;
}

bool IsBeyond(const GasGeometry& geometry, const GasState& state, const Contact& contact) {
  const auto& position = state.balls[static_cast<size_t>(contact.ball)].position;
  const auto piston = static_cast<size_t>(geometry.PistonOf(contact.ball, contact.direction));
  return SeenToward(contact.direction, position).x() >=
         0.5 + SignOf(contact.direction) * state.pistons[piston].offset;
}

// The contacts in which these balls are beyond a piston.
std::vector<Contact> WrongOf(const GasGeometry& geometry, const GasState& state,
                             const std::vector<int64_t>& balls) {
  std::vector<Contact> wrong;
  for (const int64_t ball : balls) {
    for (int i = 0; i < geometry.directions(); ++i) {
      const Contact contact = {ball, geometry.DirectionAt(i)};
      if (IsBeyond(geometry, state, contact)) wrong.push_back(contact);
    }
  }
  return wrong;
}

// Draws the places of these contacts again. Returns the balls that may then be beyond a piston, in
// order: both balls of each piston.
std::vector<int64_t> DrawAgain(const GasGeometry& geometry, const std::vector<Contact>& contacts,
                               CounterRandom& random, GasState& state) {
  std::vector<int64_t> suspects;
  for (const auto& [ball, direction] : contacts) {
    const int64_t piston = geometry.PistonOf(ball, direction);
    DrawPlace(geometry, random, state.balls[static_cast<size_t>(ball)]);
    DrawPlace(geometry, random, state.pistons[static_cast<size_t>(piston)]);
    const int64_t other = geometry.BallOf(piston, Opposite(direction));
    suspects.push_back(ball);
    if (other != GasGeometry::kNoBall) suspects.push_back(other);
  }
  std::sort(suspects.begin(), suspects.end());
  suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
  return suspects;
}

void Separate(const GasGeometry& geometry, CounterRandom& random, GasState& state) {
  std::vector<int64_t> suspects(state.balls.size());
  std::iota(suspects.begin(), suspects.end(), 0);
  while (!suspects.empty()) {
    suspects = DrawAgain(geometry, WrongOf(geometry, state, suspects), random, state);
  }
}

// ---- velocities ----

void DrawVelocities(const GasGeometry& geometry, const TemperatureProfile& temperature,
                    CounterRandom& random, GasState& state) {
  for (size_t i = 0; i < state.balls.size(); ++i) {
    const int64_t column = static_cast<int64_t>(i) % geometry.shape().columns;
    // In two dimensions the speed has the flux law.
    state.balls[i].speed = DrawFluxSpeed(temperature.At(static_cast<double>(column) + 0.5), random);
    state.balls[i].direction = UniformDirection(random);
  }
  for (size_t i = 0; i < state.pistons.size(); ++i) {
    const double x = geometry.PositionOfPiston(static_cast<int64_t>(i));
    state.pistons[i].velocity = DrawThermalVelocity(temperature.At(x), random);
  }
}

}  // namespace

double DrawThermalVelocity(double temperature, CounterRandom& random) {
  const double speed = DrawFluxSpeed(temperature, random);
  return speed * UniformDirection(random).x();
}

GasState DrawGas(const GasGeometry& geometry, const TemperatureProfile& temperature,
                 CounterRandom& random) {
  GasState state = DrawPlaces(geometry, random);
  Separate(geometry, random, state);
  DrawVelocities(geometry, temperature, random, state);
  return state;
}

}  // namespace ballpiston
