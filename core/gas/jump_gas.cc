#include "core/gas/jump_gas.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/arithmetic/elementary_functions.h"
#include "core/sampling/direction.h"

namespace ballpiston {
namespace {

// Means of (v1)+ over the ball's angle, and of (-v3)+ over the piston's sign, by their speeds; the
// latter also over the thermal law at temperature T.
double ByBallSpeed(double speed) { return speed / std::numbers::pi; }
double ByPistonSpeed(double speed) { return speed / 2; }
double ByTemperature(double temperature) { return std::sqrt(temperature / (2 * std::numbers::pi)); }

}  // namespace

JumpGas::JumpGas(const GasGeometry& geometry, double density, const GasState& start,
                 ThermalWalls walls, const CounterRandom& random)
    : geometry_(geometry),
      density_(density),
      walls_(std::move(walls)),
      random_(random),
      weights_(start.balls.size() + start.pistons.size()) {
  for (const GasBall& ball : start.balls) balls_.push_back(ball.speed);
  for (const GasPiston& piston : start.pistons) pistons_.push_back(std::fabs(piston.velocity));
  for (size_t i = 0; i < balls_.size(); ++i) SetBallWeight(static_cast<int64_t>(i));
  for (size_t i = 0; i < pistons_.size(); ++i) SetPistonWeight(static_cast<int64_t>(i));
  FindNext();
}

void JumpGas::AdvanceTo(double time, GasMeter& meter) {
  while (time_ <= time) {
    const Proposal& p = next_;
    const double ball = std::sqrt(p.v3 * p.v3 + p.across * p.across);
    balls_[static_cast<size_t>(p.ball)] = ball;
    pistons_[static_cast<size_t>(p.piston)] = std::fabs(p.v1);
    const double piston_energy =
        walls_.Has(p.piston) ? walls_.TemperatureAt(p.piston) / 2 : p.v1 * p.v1 / 2;
    meter.Exchange({time_, p.ball, p.piston, p.direction, ball * ball / 2, piston_energy});
    SetBallWeight(p.ball);
    SetPistonWeight(p.piston);
    FindNext();
  }
}

void JumpGas::SetBallWeight(int64_t ball) {
  const auto i = static_cast<size_t>(ball);
  weights_.Set(i, geometry_.directions() * ByBallSpeed(balls_[i]));
}

void JumpGas::SetPistonWeight(int64_t piston) {
  const auto i = static_cast<size_t>(piston);
  const double weight = walls_.Has(piston) ? ByTemperature(walls_.TemperatureAt(piston))
                                           : 2 * ByPistonSpeed(pistons_[i]);
  weights_.Set(balls_.size() + i, weight);
}

// Proposals come at the sum of all bounds, which an exchange changes; the product of a uniform
// number for each is the exponential of their waiting time.
void JumpGas::FindNext() {
  const double bound = weights_.Bound();
  double product = 1;
  do {
    product *= random_.Uniform();
    const std::optional<size_t> body = weights_.At(bound * random_.Uniform());
    next_.is_accepted = false;
    if (body) Propose(*body);
  } while (!next_.is_accepted);
  time_ -= Log(product) / (density_ * bound);
}

void JumpGas::Propose(size_t body) {
  if (body < balls_.size()) {
    ByBall(static_cast<int64_t>(body));
  } else {
    ByPiston(static_cast<int64_t>(body - balls_.size()));
  }
}

// v1 has the density v1 over the angles with v1 > 0: its other component is uniform.
void JumpGas::ByBall(int64_t ball) {
  const double speed = balls_[static_cast<size_t>(ball)];
  const double place = geometry_.directions() * random_.Uniform();
  const Direction direction = geometry_.DirectionAt(static_cast<int>(place));
  const double across = random_.Uniform();
  const int64_t piston = geometry_.PistonOf(ball, direction);
  next_ = {.ball = ball,
           .piston = piston,
           .direction = direction,
           .v1 = speed * std::sqrt((1 - across) * (1 + across)),
           .across = speed * across,
           .v3 = DrawPistonVelocity(piston)};
  Accept();
}

double JumpGas::DrawPistonVelocity(int64_t piston) {
  if (walls_.Has(piston)) return DrawThermalVelocity(walls_.TemperatureAt(piston), random_);
  const double speed = pistons_[static_cast<size_t>(piston)];
  return random_.Uniform() < 0.5 ? speed : -speed;
}

// The piston comes toward the ball; an outermost one with the flux law.
void JumpGas::ByPiston(int64_t piston) {
  const Direction direction = geometry_.DirectionTo(piston);
  Direction side = direction;
  double speed = 0;
  if (walls_.Has(piston)) {
    side = walls_.IsHot(piston) ? Direction::kLeft : Direction::kRight;
    speed = DrawFluxSpeed(walls_.TemperatureAt(piston), random_);
  } else {
    side = random_.Uniform() < 0.5 ? direction : Opposite(direction);
    speed = pistons_[static_cast<size_t>(piston)];
  }
  const int64_t ball = geometry_.BallOf(piston, side);
  const Eigen::Vector2d velocity = UniformDirection(random_) * balls_[static_cast<size_t>(ball)];
  next_ = {.ball = ball,
           .piston = piston,
           .direction = side,
           .v1 = velocity.x(),
           .across = velocity.y(),
           .v3 = -speed};
  Accept();
}

void JumpGas::Accept() {
  const double bound = std::max(next_.v1, 0.0) + std::max(-next_.v3, 0.0);
  next_.is_accepted = random_.Uniform() * bound < next_.v1 - next_.v3;
}

}  // namespace ballpiston
