#include "core/gas/gas_tangents.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "core/arithmetic/elementary_functions.h"
#include "core/billiard/tangent_map.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {
namespace {

// In four hits of a ball lengths grow by some hundreds, and by more for a fast ball, which hits
// more often. The smallest vector loses the square of this factor in precision.
constexpr size_t kHitsOfABallTogether = 4;

// The power of a degree of freedom whose position and velocity are 0.
constexpr double kPowerOfZero = -1e15;

// 2^power, for whole numbers up to 1023; 0 where it is below the normal numbers.
double PowerOfTwo(double power) {
  if (power < -1022) return 0;
  return std::bit_cast<double>(static_cast<uint64_t>(static_cast<int64_t>(power) + 1023) << 52);
}

// The indices of velocities among a vector's components, and the gas's velocity there.
std::vector<std::pair<size_t, double>> VelocitiesOf(const GasState& state) {
  std::vector<std::pair<size_t, double>> velocities;
  size_t component = 0;
  for (const GasBall& ball : state.balls) {
    velocities.emplace_back(component + 2, ball.speed * ball.direction.x());
    velocities.emplace_back(component + 3, ball.speed * ball.direction.y());
    component += 4;
  }
  for (const GasPiston& piston : state.pistons) {
    velocities.emplace_back(component + 1, piston.velocity);
    component += 2;
  }
  return velocities;
}

}  // namespace

GasTangents::GasTangents(double rho, const GasState& start, const std::vector<Vector>& vectors)
    : rho_(rho),
      freedoms_(2 * start.balls.size() + start.pistons.size(), Freedom(vectors.size())),
      growth_(vectors.size()),
      products_(vectors.size()),
      powers_(vectors.size()) {
  for (const GasBall& ball : start.balls) directions_.push_back(ball.direction);
  for (size_t k = 0; k < vectors.size(); ++k) {
    const double* from = vectors[k].data();
    for (int64_t ball = 0; ball < std::ssize(directions_); ++ball, from += 4) {
      const Eigen::Vector2d& u = directions_[static_cast<size_t>(ball)];
      const Eigen::Vector2d position(from[0], from[1]), velocity(from[2], from[3]);
      const Eigen::Vector2d across(-u.y(), u.x());
      Across(ball).position[k] = across.dot(position);
      Across(ball).velocity[k] = across.dot(velocity);
      Along(ball).position[k] = u.dot(position);
      Along(ball).velocity[k] = u.dot(velocity);
    }
    for (int64_t piston = 0; piston < std::ssize(start.pistons); ++piston, from += 2) {
      OfPiston(piston).position[k] = from[0];
      OfPiston(piston).velocity[k] = from[1];
    }
  }
}

void GasTangents::Follow(const GasEvent& event, const GasBall& after) {
  Move(event);
  if (event.kind == EventKind::kPistonWall) OfPiston(event.piston).ChangeSigns();
  if (event.kind == EventKind::kBallPiston) Exchange(event, after);
  if (event.kind != EventKind::kBallWall) return;
  ReflectBall(event.ball, after);
  if (++hits_ >= kHitsOfABallTogether * directions_.size()) Orthonormalise(event.time);
}

std::vector<double> GasTangents::TakeGrowth(double time) {
  Orthonormalise(time);
  return std::exchange(growth_, std::vector<double>(growth_.size()));
}

void GasTangents::Move(const GasEvent& event) {
  if (event.ball >= 0) {
    Across(event.ball).MoveTo(event.time);
    Along(event.ball).MoveTo(event.time);
  }
  if (event.piston >= 0) OfPiston(event.piston).MoveTo(event.time);
}

void GasTangents::Freedom::MoveTo(double now) {
  const double wait = now - std::exchange(time, now);
  for (size_t k = 0; k < position.size(); ++k) position[k] += wait * velocity[k];
}

void GasTangents::Freedom::ChangeSigns() {
  for (double& x : position) x = -x;
  for (double& v : velocity) v = -v;
}

// The disc is the one in the ball's quadrant, n its normal, u the ball's direction after the hit:
// cos(phi) = n.u.
void GasTangents::ReflectBall(int64_t ball, const GasBall& after) {
  const double x = after.position.x(), y = after.position.y();
  const Eigen::Vector2d& u = after.direction;
  const double cosine =
      ((x - std::copysign(0.5, x)) * u.x() + (y - std::copysign(0.5, y)) * u.y()) / rho_;
  const double kick = 2 * after.speed / (rho_ * std::max(cosine, kSmallestCosine<double>));
  Freedom& across = Across(ball);
  for (size_t k = 0; k < across.position.size(); ++k) {
    across.velocity[k] += kick * across.position[k];
  }
  across.ChangeSigns();
  directions_[static_cast<size_t>(ball)] = u;
}

// The ball's components along the piston's axis change places with the piston's.
void GasTangents::Exchange(const GasEvent& event, const GasBall& after) {
  Eigen::Vector2d& direction = directions_[static_cast<size_t>(event.ball)];
  const Direction axis = IsAlongX(event.direction) ? Direction::kRight : Direction::kUp;
  const Eigen::Vector2d before = SeenToward(axis, direction);
  const Eigen::Vector2d now = SeenToward(axis, after.direction);
  Freedom &across = Across(event.ball), &along = Along(event.ball);
  Freedom& piston = OfPiston(event.piston);
  for (size_t k = 0; k < growth_.size(); ++k) {
    const double of_ball = std::max(across.power[k], along.power[k]);
    const double of_all = std::max(of_ball, piston.power[k]);
    const double of_across = PowerOfTwo(across.power[k] - of_ball);
    const double of_along = PowerOfTwo(along.power[k] - of_ball);
    const double of_off_axis = PowerOfTwo(of_ball - of_all);
    const double of_piston = PowerOfTwo(piston.power[k] - of_all);
    const auto exchange = [&](double& a, double& l, double& q) {
      const double on_axis = before.x() * of_along * l - before.y() * of_across * a;
      const double off_axis =
          of_off_axis * (before.y() * of_along * l + before.x() * of_across * a);
      a = now.x() * off_axis - now.y() * of_piston * q;
      l = now.y() * off_axis + now.x() * of_piston * q;
      q = on_axis;
    };
    exchange(across.position[k], along.position[k], piston.position[k]);
    exchange(across.velocity[k], along.velocity[k], piston.velocity[k]);
    across.power[k] = along.power[k] = of_all;
    piston.power[k] = of_ball;
  }
  direction = after.direction;
}

// The sums are written out, in one order on every processor.
void GasTangents::Orthonormalise(double time) {
  hits_ = 0;
  for (Freedom& freedom : freedoms_) {
    freedom.MoveTo(time);
    freedom.SetPowers();
  }
  for (size_t k = 0; k < growth_.size(); ++k) {
    MultiplyByLater(k);
    SubtractFromLater(k);
    Normalise(k);
  }
}

// Chooses powers so that the larger one of position and velocity is in [1, 2).
void GasTangents::Freedom::SetPowers() {
  for (size_t k = 0; k < position.size(); ++k) {
    const double largest = std::max(std::fabs(position[k]), std::fabs(velocity[k]));
    if (largest == 0) {
      power[k] = kPowerOfZero;
      continue;
    }
    const int exponent = std::ilogb(largest);
    position[k] = std::ldexp(position[k], -exponent);
    velocity[k] = std::ldexp(velocity[k], -exponent);
    power[k] += exponent;
  }
}

void GasTangents::MultiplyByLater(size_t k) {
  std::fill(products_.begin(), products_.end(), 0.0);
  std::fill(powers_.begin(), powers_.end(), 2 * kPowerOfZero);
  for (const Freedom& of : freedoms_) {
    for (size_t j = k; j < powers_.size(); ++j) {
      powers_[j] = std::max(powers_[j], of.power[k] + of.power[j]);
    }
  }
  for (const auto& [position, velocity, power, time] : freedoms_) {
    for (size_t j = k; j < products_.size(); ++j) {
      products_[j] += (position[k] * position[j] + velocity[k] * velocity[j]) *
                      PowerOfTwo(power[k] + power[j] - powers_[j]);
    }
  }
}

// The products become the later vectors' shares of this one.
void GasTangents::SubtractFromLater(size_t k) {
  for (size_t j = k + 1; j < products_.size(); ++j) {
    products_[j] /= products_[k];
    powers_[j] -= powers_[k];
  }
  for (auto& [position, velocity, power, time] : freedoms_) {
    for (size_t j = k + 1; j < products_.size(); ++j) {
      const double of_share = powers_[j] + power[k], largest = std::max(power[j], of_share);
      const double kept = PowerOfTwo(power[j] - largest);
      const double share = products_[j] * PowerOfTwo(of_share - largest);
      position[j] = kept * position[j] - share * position[k];
      velocity[j] = kept * velocity[j] - share * velocity[k];
      power[j] = largest;
    }
  }
}

void GasTangents::Normalise(size_t k) {
  const double length = std::sqrt(products_[k]);
  const double power_of_length = powers_[k] / 2;  // whole: of the product with itself
  growth_[k] += Log(length) + power_of_length * std::numbers::ln2;
  for (auto& [position, velocity, power, time] : freedoms_) {
    position[k] /= length;
    velocity[k] /= length;
    power[k] -= power_of_length;
  }
}

// Every ball's velocity has components along and across its path, at random. If a component were 0,
// rounding would decide when the vector turns to that ball.
std::vector<GasTangents::Vector> VelocitiesAcross(const GasState& state) {
  const auto w = VelocitiesOf(state);
  double squared = 0;
  for (const auto& [component, velocity] : w) squared += velocity * velocity;
  std::vector<GasTangents::Vector> vectors;
  for (size_t k = 0; k + 1 < w.size(); ++k) {
    CounterRandom random(0, 0, k);
    GasTangents::Vector vector(2 * w.size());
    double product = 0;
    for (const auto& [component, velocity] : w) {
      vector[component] = random.Uniform() - 0.5;
      product += vector[component] * velocity;
    }
    for (const auto& [component, velocity] : w) vector[component] -= product / squared * velocity;
    vectors.push_back(std::move(vector));
  }
  return vectors;
}

}  // namespace ballpiston
