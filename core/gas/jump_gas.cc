#include "core/gas/jump_gas.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace ballpiston {
namespace {

// A ball proposes an exchange to each of its pistons at a rate equal to the mean of (v1)+ over its
// angle, v/pi. A piston proposes to each of its two balls at the mean of (-v3)+ over its sign, v/2.
constexpr double kBallsRatePerPiston = 1 / std::numbers::pi;
constexpr double kPistonsRate = 2 * 0.5;

constexpr int kExchangesOfACall = 20'000;  // of 100 ns

// The rates are found again after as many exchanges as there are bodies, or after:
constexpr size_t kFewestExchanges = 64;

}  // namespace

JumpGas::JumpGas(const GasGeometry& geometry, double density, const GasState& start,
                 ThermalWalls walls, const CounterRandom& random)
    : geometry_(geometry),
      density_(density),
      walls_(std::move(walls)),
      random_(random),
      balls_(start.balls.size()) {
  speeds_.resize(balls_ + start.pistons.size());
  for (size_t body = 0; body < speeds_.size(); ++body) speeds_[body] = SpeedAtStart(body, start);
  const auto count = static_cast<double>(balls_);
  kinds_[0] = {.count = count};
  kinds_[1] = {.first = count, .count = static_cast<double>(start.pistons.size())};
  FindRates();
  FindNext();
}

double JumpGas::SpeedAtStart(size_t body, const GasState& start) const {
  if (body < balls_) return start.balls[body].speed;
  const auto piston = static_cast<int64_t>(body - balls_);
  return walls_.Has(piston) ? SpeedOfOutermost(piston)
                            : std::fabs(start.pistons[body - balls_].velocity);
}

GasState JumpGas::State() const {
  GasState state;
  for (size_t body = 0; body < speeds_.size(); ++body) {
    if (body < balls_) {
      state.balls.push_back({.speed = speeds_[body]});
      continue;
    }
    const auto piston = static_cast<int64_t>(body - balls_);
    const double speed =
        walls_.Has(piston) ? std::sqrt(walls_.TemperatureAt(piston)) : speeds_[body];
    state.pistons.push_back({.velocity = speed});
  }
  return state;
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
  double rate = 0, largest[2] = {};  // in registers
  for (size_t body = 0; body < speeds_.size(); ++body) {
    rate += RatePerSpeed(body) * speeds_[body];
    double& of_kind = largest[body < balls_ ? 0 : 1];
    of_kind = std::max(of_kind, speeds_[body]);
  }
  rate_ = rate;
  kinds_[0].largest = largest[0];
  kinds_[1].largest = largest[1];
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

bool JumpGas::AdvanceToward(double time, GasMeter& meter) {
  for (int i = 0; i < kExchangesOfACall; ++i) {
    if (time_ > time) return true;
    Exchange(meter);
    if (++changes_ > std::max(speeds_.size(), kFewestExchanges)) FindRates();
    FindNext();
  }
  return false;
}

void JumpGas::Exchange(GasMeter& meter) {
  const auto& [ball, piston, direction, v1, v3] = next_;
  const double speed = speeds_[static_cast<size_t>(ball)];
  const double ball_energy = (v3 * v3 + (speed - v1) * (speed + v1)) / 2;
  double piston_energy = v1 * v1 / 2;
  SetSpeed(static_cast<size_t>(ball), std::sqrt(2 * ball_energy));
  if (walls_.Has(piston)) {
    piston_energy = walls_.TemperatureAt(piston) / 2;
  } else {
    SetSpeed(balls_ + static_cast<size_t>(piston), std::fabs(v1));
  }
  meter.Exchange(
      {EventKind::kBallPiston, time_, ball, piston, direction, ball_energy, piston_energy});
}

// The lowest bits of the word that chose the body choose the contact; they are still unused. What
// is left of the attempt's least speed decides, because it is uniform below the body's speed.
void JumpGas::FindNext() {
  double wait = 0;
  for (;;) {
    const size_t attempt = NextAttempt();
    if (used_proposals_ == kJumpDraws) {
      DrawJumpProposals(random_, proposals_);
      used_proposals_ = 0;
    }
    const size_t i = used_proposals_++;
    const auto body = static_cast<size_t>(attempts_.bodies[attempt]);
    const uint64_t bits = attempts_.words[attempt];
    if (body < balls_) {
      ByBall(static_cast<int64_t>(body), bits, proposals_.cosines[0][i]);
    } else {
      ByPiston(static_cast<int64_t>(body - balls_), bits, proposals_.cosines[1][i]);
    }
    wait += proposals_.waits[i];
    const double bound = std::max(next_.v1, 0.0) + std::max(-next_.v3, 0.0);
    const double least = attempts_.least_speeds[attempt];
    if (least * bound < speeds_[body] * (next_.v1 - next_.v3)) break;
  }
  time_ += wait / (density_ * rate_);
}

// The next one at which the body proposes an exchange.
size_t JumpGas::NextAttempt() {
  for (;;) {
    if (used_attempts_ == kJumpDraws) DrawAttempts();
    const size_t i = used_attempts_++;
    if (attempts_.least_speeds[i] < speeds_[static_cast<size_t>(attempts_.bodies[i])]) return i;
  }
}

void JumpGas::DrawAttempts() {
  DrawJumpAttempts(kinds_, random_, attempts_);
  for (const int32_t body : attempts_.bodies)
    __builtin_prefetch(&speeds_[static_cast<size_t>(body)]);
  used_attempts_ = 0;
}

// The piston's velocity has either sign.
void JumpGas::ByBall(int64_t ball, uint64_t bits, double cosine) {
  const int way = static_cast<int>(bits >> 1) & (geometry_.directions() - 1);  // of 2 or 4
  const Direction direction = geometry_.DirectionAt(way);
  const int64_t piston = geometry_.PistonOf(ball, direction);
  const double speed = speeds_[balls_ + static_cast<size_t>(piston)];
  next_ = {.ball = ball,
           .piston = piston,
           .direction = direction,
           .v1 = speeds_[static_cast<size_t>(ball)] * cosine,
           .v3 = (bits & 1) != 0 ? -speed : speed};
  if (walls_.Has(piston)) next_.v3 = DrawThermalVelocity(walls_.TemperatureAt(piston), random_);
}

// The piston moves toward the ball. An outermost piston has a speed from the flux law.
void JumpGas::ByPiston(int64_t piston, uint64_t bits, double cosine) {
  const Direction direction = geometry_.DirectionTo(piston);
  Direction side = (bits & 1) != 0 ? direction : Opposite(direction);
  double speed = speeds_[balls_ + static_cast<size_t>(piston)];
  if (walls_.Has(piston)) {
    side = walls_.IsHot(piston) ? Direction::kLeft : Direction::kRight;
    speed = DrawFluxSpeed(walls_.TemperatureAt(piston), random_);
  }
  const int64_t ball = geometry_.BallOf(piston, side);
  next_ = {.ball = ball,
           .piston = piston,
           .direction = side,
           .v1 = speeds_[static_cast<size_t>(ball)] * cosine,
           .v3 = -speed};
}

}  // namespace ballpiston
