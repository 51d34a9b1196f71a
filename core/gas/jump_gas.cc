#include "core/gas/jump_gas.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "core/arithmetic/elementary_functions.h"
#include "core/sampling/direction.h"

namespace ballpiston {
namespace {

// A ball proposes an exchange to each of its pistons at the rate of the mean of (v1)+ over its
// angle, v/pi; a piston to each of its two balls at that of (-v3)+ over its sign, v/2.
constexpr double kOfABall = 1 / std::numbers::pi;
constexpr double kOfAPiston = 2 * 0.5;

// The speed at which a piston with two balls proposes as often as an outermost one does to its one:
// the mean of (-v3)+ at temperature T.
double SpeedOfOutermost(double temperature) {
  return std::sqrt(temperature / (2 * std::numbers::pi)) / kOfAPiston;
}

}  // namespace

JumpGas::JumpGas(const GasGeometry& geometry, double density, const GasState& start,
                 ThermalWalls walls, const CounterRandom& random)
    : geometry_(geometry),
      density_(density),
      walls_(std::move(walls)),
      random_(random),
      balls_(start.balls.size()) {
  for (const GasBall& ball : start.balls) speeds_.push_back(ball.speed);
  for (size_t i = 0; i < start.pistons.size(); ++i) {
    const auto piston = static_cast<int64_t>(i);
    speeds_.push_back(walls_.Has(piston) ? SpeedOfOutermost(walls_.TemperatureAt(piston))
                                         : std::fabs(start.pistons[i].velocity));
  }
  FindLargest();
  FindNext();
}

void JumpGas::FindLargest() {
  const auto first_piston = speeds_.begin() + static_cast<std::ptrdiff_t>(balls_);
  kinds_[0].largest = *std::max_element(speeds_.begin(), first_piston);
  kinds_[1].largest = *std::max_element(first_piston, speeds_.end());
  SetRates();
  changes_ = 0;
}

void JumpGas::SetRates() {
  const double of_a_speed[] = {geometry_.directions() * kOfABall, kOfAPiston};
  const size_t ends[] = {0, balls_, speeds_.size()};
  rate_ = 0;
  for (size_t i = 0; i < kinds_.size(); ++i) {
    Kind& kind = kinds_[i];
    const double each = of_a_speed[i] * kind.largest;
    kind.first = ends[i];
    kind.last = ends[i + 1] - 1;
    kind.before = rate_;
    kind.rate = each * static_cast<double>(ends[i + 1] - ends[i]);
    kind.bodies_per_rate = 1 / each;
    rate_ += kind.rate;
  }
}

void JumpGas::SetSpeed(size_t body, double speed) {
  speeds_[body] = speed;
  Kind& kind = kinds_[body < balls_ ? 0 : 1];
  if (speed <= kind.largest) return;
  kind.largest = speed;
  SetRates();
}

void JumpGas::AdvanceTo(double time, GasMeter& meter) {
  while (time_ <= time) {
    const Proposal& p = next_;
    const double ball = std::sqrt(p.v3 * p.v3 + p.across * p.across);
    double piston_energy = p.v1 * p.v1 / 2;
    SetSpeed(static_cast<size_t>(p.ball), ball);
    if (walls_.Has(p.piston)) {
      piston_energy = walls_.TemperatureAt(p.piston) / 2;
    } else {
      SetSpeed(balls_ + static_cast<size_t>(p.piston), std::fabs(p.v1));
    }
    meter.Exchange({time_, p.ball, p.piston, p.direction, ball * ball / 2, piston_energy});
    if (++changes_ > speeds_.size()) FindLargest();
    FindNext();
  }
}

// Proposals come at the rate of as many bodies as fast as the fastest; the product of a uniform
// number for each is the exponential of their waiting time.
void JumpGas::FindNext() {
  double product = 1;
  do {
    product *= random_.Uniform();
    next_.is_accepted = false;
    Propose(NextPlace());
  } while (!next_.is_accepted);
  time_ -= Log(product) / (density_ * rate_);
}

// Draws ahead, so that the speeds are on their way from memory.
double JumpGas::NextPlace() {
  if (used_places_ == places_.size()) {
    for (double& place : places_) {
      place = random_.Uniform();
      __builtin_prefetch(&speeds_[BodyAt(rate_ * place).body]);
    }
    used_places_ = 0;
  }
  return rate_ * places_[used_places_++];
}

JumpGas::Chosen JumpGas::BodyAt(double place) const {
  const Kind& kind = kinds_[place < kinds_[0].rate ? 0 : 1];
  const double index = (place - kind.before) * kind.bodies_per_rate;
  const size_t body = std::min(kind.first + static_cast<size_t>(index), kind.last);
  return {body, (index - static_cast<double>(body - kind.first)) * kind.largest};
}

// The number chooses a body, and its rest decides whether that one is fast enough. Without
// branches, because they would be mispredicted.
void JumpGas::Propose(double place) {
  const auto [body, least_speed] = BodyAt(place);
  if (least_speed >= speeds_[body]) return;
  if (body < balls_) {
    ByBall(static_cast<int64_t>(body));
  } else {
    ByPiston(static_cast<int64_t>(body - balls_));
  }
}

// v1 has the density v1 over the angles with v1 > 0: its other component is uniform.
void JumpGas::ByBall(int64_t ball) {
  const double speed = speeds_[static_cast<size_t>(ball)];
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
  const double speed = speeds_[balls_ + static_cast<size_t>(piston)];
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
    speed = speeds_[balls_ + static_cast<size_t>(piston)];
  }
  const int64_t ball = geometry_.BallOf(piston, side);
  const Eigen::Vector2d velocity = UniformDirection(random_) * speeds_[static_cast<size_t>(ball)];
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
