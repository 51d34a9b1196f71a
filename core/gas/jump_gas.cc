#include "core/gas/jump_gas.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "core/sampling/direction.h"

namespace ballpiston {
namespace {

// A ball proposes an exchange to each of its pistons at a rate equal to the mean of (v1)+ over its
// angle, v/pi. A piston proposes to each of its two balls at the mean of (-v3)+ over its sign, v/2.
constexpr double kBallsRatePerPiston = 1 / std::numbers::pi;
constexpr double kPistonsRate = 2 * 0.5;

constexpr double kNanosecondsOfAnExchange = 200;
constexpr double kNanosecondsOfABody = 10;

}  // namespace

JumpGas::JumpGas(const GasGeometry& geometry, double density, ThermalWalls walls,
                 const CounterRandom& random)
    : geometry_(geometry),
      density_(density),
      walls_(std::move(walls)),
      random_(random),
      balls_(static_cast<size_t>(geometry.balls())) {
  speeds_.reserve(balls_ + static_cast<size_t>(geometry.pistons()));
}

JumpGas::JumpGas(const GasGeometry& geometry, double density, const GasState& start,
                 ThermalWalls walls, const CounterRandom& random)
    : JumpGas(geometry, density, std::move(walls), random) {
  Pauses never;
  Begin(start, never);
}

bool JumpGas::Begin(const GasState& start, Pauses& pauses) {
  const auto take = [&](size_t body) { speeds_.push_back(SpeedAtStart(body, start)); };
  size_t next = speeds_.size();
  if (!ForEachWithPauses(next, balls_ + start.pistons.size(), kNanosecondsOfABody, pauses, take)) {
    return false;
  }
  const auto count = static_cast<double>(balls_);
  kinds_[0] = {.count = count};
  kinds_[1] = {.first = count, .count = static_cast<double>(speeds_.size()) - count};
  FindRates();
  FindNext();
  return true;
}

double JumpGas::SpeedAtStart(size_t body, const GasState& start) const {
  if (body < balls_) return start.balls[body].speed;
  const auto piston = static_cast<int64_t>(body - balls_);
  return walls_.Has(piston) ? SpeedOfOutermost(piston)
                            : std::fabs(start.pistons[body - balls_].velocity);
}

// An outermost piston proposes to one ball, at a rate equal to the mean of (-v3)+. Returns the
// speed at which a piston with two balls has the same rate of proposals.
double JumpGas::SpeedOfOutermost(int64_t piston) const {
  return std::sqrt(walls_.TemperatureAt(piston) / (2 * std::numbers::pi)) / kPistonsRate;
}

double JumpGas::RatePerSpeed(size_t body) const {
  return body < balls_ ? geometry_.directions() * kBallsRatePerPiston : kPistonsRate;
}

// Called again from time to time, because `rate_` accumulates rounding errors, and because the
// fastest bodies become slower.
void JumpGas::FindRates() {
  rate_ = kinds_[0].largest = kinds_[1].largest = 0;
  for (size_t body = 0; body < speeds_.size(); ++body) {
    rate_ += RatePerSpeed(body) * speeds_[body];
    double& largest = kinds_[body < balls_ ? 0 : 1].largest;
    largest = std::max(largest, speeds_[body]);
  }
  changes_ = 0;
  FindPlaces();
}

// Places are allotted as if each body were as fast as the fastest of its kind. Words drawn in
// advance are still uniform, because they have not been used.
void JumpGas::FindPlaces() {
  auto& [balls, pistons] = kinds_;
  const double of_a_ball = RatePerSpeed(0) * balls.largest;
  const double of_a_piston = RatePerSpeed(balls_) * pistons.largest;
  const double all = of_a_ball * balls.count + of_a_piston * pistons.count;
  balls.per_place = all / of_a_ball;
  pistons.per_place = all / of_a_piston;
  pistons.before = of_a_ball * balls.count / all;
  FindJumpAttempts(kinds_, attempts_);
}

void JumpGas::SetSpeed(size_t body, double speed) {
  rate_ += RatePerSpeed(body) * (speed - speeds_[body]);
  speeds_[body] = speed;
  double& largest = kinds_[body < balls_ ? 0 : 1].largest;
  if (speed <= largest) return;
  largest = speed;
  FindPlaces();
}

bool JumpGas::AdvanceTo(double time, GasMeter& meter, Pauses& pauses) {
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
    if (++changes_ > speeds_.size()) FindRates();
    FindNext();
    if (pauses.After(kNanosecondsOfAnExchange)) return false;
  }
  return true;
}

void JumpGas::FindNext() {
  double wait = 0;
  do {
    FindProposal();
    wait += DrawWait();
  } while (!next_.is_accepted);
  time_ += wait / (density_ * rate_);
}

double JumpGas::DrawWait() {
  if (used_waits_ == kJumpDraws) {
    DrawJumpWaits(random_, waits_);
    used_waits_ = 0;
  }
  return waits_[used_waits_++];
}

// The lowest bits of the word that chose the body choose the contact; they are still unused.
void JumpGas::FindProposal() {
  for (;;) {
    if (used_attempts_ == kJumpDraws) DrawAttempts();
    const size_t i = used_attempts_++;
    const auto body = static_cast<size_t>(attempts_.bodies[i]);
    if (attempts_.least_speeds[i] < speeds_[body]) return Propose(body, attempts_.words[i]);
  }
}

void JumpGas::DrawAttempts() {
  DrawJumpAttempts(kinds_, random_, attempts_);
  for (const int32_t body : attempts_.bodies)
    __builtin_prefetch(&speeds_[static_cast<size_t>(body)]);
  used_attempts_ = 0;
}

void JumpGas::Propose(size_t body, uint64_t bits) {
  if (body < balls_) {
    ByBall(static_cast<int64_t>(body), bits);
  } else {
    ByPiston(static_cast<int64_t>(body - balls_), bits);
  }
  Decide();
}

// The angles with v1 > 0 have the weight v1, so the other component is uniform. The piston's
// velocity has either sign.
void JumpGas::ByBall(int64_t ball, uint64_t bits) {
  const double speed = speeds_[static_cast<size_t>(ball)];
  const int way = static_cast<int>(bits >> 1) & (geometry_.directions() - 1);  // of 2 or 4
  const Direction direction = geometry_.DirectionAt(way);
  const double across = random_.Uniform();
  const int64_t piston = geometry_.PistonOf(ball, direction);
  next_ = {.ball = ball,
           .piston = piston,
           .direction = direction,
           .v1 = speed * std::sqrt((1 - across) * (1 + across)),
           .across = speed * across,
           .v3 = speeds_[balls_ + static_cast<size_t>(piston)]};
  if ((bits & 1) != 0) next_.v3 = -next_.v3;
  if (walls_.Has(piston)) next_.v3 = DrawThermalVelocity(walls_.TemperatureAt(piston), random_);
}

// The piston moves toward the ball. An outermost piston has a speed from the flux law.
void JumpGas::ByPiston(int64_t piston, uint64_t bits) {
  const Direction direction = geometry_.DirectionTo(piston);
  Direction side = (bits & 1) != 0 ? direction : Opposite(direction);
  double speed = speeds_[balls_ + static_cast<size_t>(piston)];
  if (walls_.Has(piston)) {
    side = walls_.IsHot(piston) ? Direction::kLeft : Direction::kRight;
    speed = DrawFluxSpeed(walls_.TemperatureAt(piston), random_);
  }
  const int64_t ball = geometry_.BallOf(piston, side);
  const Eigen::Vector2d velocity = UniformDirection(random_) * speeds_[static_cast<size_t>(ball)];
  next_ = {.ball = ball,
           .piston = piston,
           .direction = side,
           .v1 = velocity.x(),
           .across = velocity.y(),
           .v3 = -speed};
}

void JumpGas::Decide() {
  const double proposed = std::max(next_.v1, 0.0) + std::max(-next_.v3, 0.0);
  next_.is_accepted = random_.Uniform() * proposed < next_.v1 - next_.v3;
}

}  // namespace ballpiston
