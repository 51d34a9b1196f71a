#include "core/gas/canonical_gas.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/pair_state.h"
#include "core/sampling/direction.h"

namespace ballpiston {
namespace {

// Nanoseconds of the steps of a draw.
constexpr double kToPlaceABall = 150;
constexpr double kToPlaceAPiston = 20;
constexpr double kToLookAtABall = 40;
constexpr double kToDrawAgain = 300;
constexpr double kToDrawAVelocity = 150;

}  // namespace

GasDraw::GasDraw(const GasGeometry& geometry, const TemperatureProfile& temperature,
                 CounterRandom& random)
    : geometry_(geometry), temperature_(temperature), random_(random) {
  state_.balls.reserve(static_cast<size_t>(geometry.balls()));
  state_.pistons.reserve(static_cast<size_t>(geometry.pistons()));
}

bool GasDraw::Advance(Pauses& pauses) {
  return DrawPlaces(pauses) && Separate(pauses) && DrawVelocities(pauses);
}

// ---- places ----

bool GasDraw::DrawPlaces(Pauses& pauses) {
  const auto balls = static_cast<size_t>(geometry_.balls());
  const auto pistons = static_cast<size_t>(geometry_.pistons());
  return ForEachWithPauses(placed_balls_, balls, kToPlaceABall, pauses,
                           [this](size_t ball) {
                             DrawPlace(state_.balls.emplace_back());
                             suspects_.push_back(static_cast<int64_t>(ball));
                           }) &&
         ForEachWithPauses(placed_pistons_, pistons, kToPlaceAPiston, pauses,
                           [this](size_t) { DrawPlace(state_.pistons.emplace_back()); });
}

void GasDraw::DrawPlace(GasBall& ball) {
  const double half_width = geometry_.pair().tip();
  do {
    const double x = (2 * random_.Uniform() - 1) * half_width;
    ball.position = {x, (2 * random_.Uniform() - 1) * half_width};
  } while (!InsideCell(geometry_.pair(), ball.position));
}

void GasDraw::DrawPlace(GasPiston& piston) {
  piston.offset = (2 * random_.Uniform() - 1) * geometry_.reach();
}

bool GasDraw::Separate(Pauses& pauses) {
  while (!suspects_.empty()) {
    if (!ForEachWithPauses(looked_at_, suspects_.size(), kToLookAtABall, pauses,
                           [this](size_t i) { LookForWrong(suspects_[i]); }) ||
        !ForEachWithPauses(drawn_again_, wrong_.size(), kToDrawAgain, pauses,
                           [this](size_t i) { DrawAgain(wrong_[i]); })) {
      return false;
    }
    BeginRound();
  }
  return true;
}

bool GasDraw::IsBeyond(const Contact& contact) {
  const double x = SeenToward(contact.direction, BallAt(contact.ball).position).x();
  const int64_t piston = geometry_.PistonOf(contact.ball, contact.direction);
  return x >= 0.5 + SignOf(contact.direction) * PistonAt(piston).offset;
}

void GasDraw::LookForWrong(int64_t ball) {
  for (int i = 0; i < geometry_.directions(); ++i) {
    const Contact contact = {ball, geometry_.DirectionAt(i)};
    if (IsBeyond(contact)) wrong_.push_back(contact);
  }
}

// Both balls of the piston may then be beyond it.
void GasDraw::DrawAgain(const Contact& contact) {
  const int64_t piston = geometry_.PistonOf(contact.ball, contact.direction);
  DrawPlace(BallAt(contact.ball));
  DrawPlace(PistonAt(piston));
  const int64_t other = geometry_.BallOf(piston, Opposite(contact.direction));
  next_suspects_.push_back(contact.ball);
  if (other != GasGeometry::kNoBall) next_suspects_.push_back(other);
}

void GasDraw::BeginRound() {
  std::swap(suspects_, next_suspects_);
  std::sort(suspects_.begin(), suspects_.end());
  suspects_.erase(std::unique(suspects_.begin(), suspects_.end()), suspects_.end());
  next_suspects_.clear();
  wrong_.clear();
  looked_at_ = drawn_again_ = 0;
}

// ---- velocities ----

bool GasDraw::DrawVelocities(Pauses& pauses) {
  const auto draw_ball = [this](size_t i) {
    const int64_t column = static_cast<int64_t>(i) % geometry_.shape().columns;
    // In two dimensions the speed has the flux law.
    state_.balls[i].speed =
        DrawFluxSpeed(temperature_.At(static_cast<double>(column) + 0.5), random_);
    state_.balls[i].direction = UniformDirection(random_);
  };
  const auto draw_piston = [this](size_t i) {
    const double x = geometry_.PositionOfPiston(static_cast<int64_t>(i));
    state_.pistons[i].velocity = DrawThermalVelocity(temperature_.At(x), random_);
  };
  return ForEachWithPauses(moving_balls_, state_.balls.size(), kToDrawAVelocity, pauses,
                           draw_ball) &&
         ForEachWithPauses(moving_pistons_, state_.pistons.size(), kToDrawAVelocity, pauses,
                           draw_piston);
}

double DrawThermalVelocity(double temperature, CounterRandom& random) {
  const double speed = DrawFluxSpeed(temperature, random);
  return speed * UniformDirection(random).x();
}

GasState DrawGas(const GasGeometry& geometry, const TemperatureProfile& temperature,
                 CounterRandom& random) {
  GasDraw draw(geometry, temperature, random);
  draw.Advance(NoPauses());
  return draw.Take();
}

}  // namespace ballpiston
