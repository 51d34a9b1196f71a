#include "core/gas/canonical_gas.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/geometry/pair_state.h"
#include "core/sampling/direction.h"

namespace ballpiston {
namespace {

class PlaceSampler {
 public:
  PlaceSampler(const GasGeometry& geometry, CounterRandom& random, GasState& state)
      : geometry_(geometry), random_(random), state_(state) {}

  void Draw() {
    for (GasBall& ball : state_.balls) DrawPlace(ball);
    for (GasPiston& piston : state_.pistons) DrawPlace(piston);
    std::vector<int64_t> suspects(state_.balls.size());
    std::iota(suspects.begin(), suspects.end(), 0);
    while (!suspects.empty()) {
      const std::vector<Event> wrong = WrongAmong(suspects);
      suspects = DrawAgain(wrong);
    }
  }

 private:
  struct Event {
    int64_t ball;
    Direction direction;
  };

  GasBall& BallAt(int64_t i) const { return state_.balls[static_cast<size_t>(i)]; }
  GasPiston& PistonAt(int64_t i) const { return state_.pistons[static_cast<size_t>(i)]; }

  void DrawPlace(GasBall& ball) const {
    const double half_width = geometry_.pair().tip();
    do {
      const double x = (2 * random_.Uniform() - 1) * half_width;
      ball.position = {x, (2 * random_.Uniform() - 1) * half_width};
    } while (!InsideCell(geometry_.pair(), ball.position));
  }

  void DrawPlace(GasPiston& piston) const {
    piston.offset = (2 * random_.Uniform() - 1) * geometry_.reach();
  }

  bool IsBeyond(const Event& event) const {
    const double x = SeenToward(event.direction, BallAt(event.ball).position).x();
    const int64_t piston = geometry_.PistonOf(event.ball, event.direction);
    return x >= 0.5 + SignOf(event.direction) * PistonAt(piston).offset;
  }

  std::vector<Event> WrongAmong(const std::vector<int64_t>& balls) const {
    std::vector<Event> wrong;
    for (const int64_t ball : balls) {
      for (int i = 0; i < geometry_.directions(); ++i) {
        const Event event = {ball, geometry_.DirectionAt(i)};
        if (IsBeyond(event)) wrong.push_back(event);
      }
    }
    return wrong;
  }

  // Returns the balls that were drawn again, or that see a piston that was.
  std::vector<int64_t> DrawAgain(const std::vector<Event>& events) const {
    std::vector<int64_t> suspects;
    for (const Event& event : events) {
      const int64_t piston = geometry_.PistonOf(event.ball, event.direction);
      DrawPlace(BallAt(event.ball));
      DrawPlace(PistonAt(piston));
      const int64_t other = geometry_.BallOf(piston, Opposite(event.direction));
      suspects.push_back(event.ball);
      if (other != GasGeometry::kNoBall) suspects.push_back(other);
    }
    std::sort(suspects.begin(), suspects.end());
    suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
    return suspects;
  }

  const GasGeometry& geometry_;
  CounterRandom& random_;
  GasState& state_;
};

}  // namespace

double DrawThermalVelocity(double temperature, CounterRandom& random) {
  const double speed = DrawFluxSpeed(temperature, random);
  return speed * UniformDirection(random).x();
}

GasState DrawGas(const GasGeometry& geometry, const TemperatureProfile& temperature,
                 CounterRandom& random) {
  GasState state;
  state.balls.resize(static_cast<size_t>(geometry.balls()));
  state.pistons.resize(static_cast<size_t>(geometry.pistons()));
  PlaceSampler(geometry, random, state).Draw();
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
  return state;
}

}  // namespace ballpiston
