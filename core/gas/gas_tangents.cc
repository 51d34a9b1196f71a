#include "core/gas/gas_tangents.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/arithmetic/elementary_functions.h"
#include "core/billiard/tangent_map.h"

namespace ballpiston {
namespace {

// In two hits of each ball lengths grow by a factor of some hundreds, and by 10^7 at most if one
// ball is fast. The smallest vector loses this factor in precision.
constexpr size_t kHitsOfABallTogether = 2;

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

GasTangents::GasTangents(const GasGeometry& geometry, const std::vector<Vector>& start)
    : balls_(static_cast<size_t>(geometry.balls())),
      pistons_(static_cast<size_t>(geometry.pistons())),
      count_(start.size()),
      rho_(geometry.pair().rho()),
      rows_(2 * DegreesOfFreedom(geometry) * count_),
      times_(balls_ + pistons_),
      growth_(count_),
      vector_(2 * DegreesOfFreedom(geometry)),
      shares_(count_) {
  for (size_t k = 0; k < count_; ++k) {
    for (size_t i = 0; i < vector_.size(); ++i) Row(i)[k] = start[k][i];
  }
}

void GasTangents::Follow(const GasEvent& event, const ReferenceGas& gas) {
  if (event.ball >= 0) MoveBall(event.ball, event.time);
  if (event.piston >= 0) MovePiston(event.piston, event.time);
  switch (event.kind) {
    case EventKind::kBallWall:
      ReflectBall(event.ball, gas.BallAt(event.ball, event.time));
      if (++hits_ >= kHitsOfABallTogether * balls_) Orthonormalise(event.time);
      break;
    case EventKind::kPistonWall:
      ReflectPiston(event.piston);
      break;
    case EventKind::kBallPiston:
      Exchange(event);
      break;
    case EventKind::kEscape:
      break;
  }
}

std::vector<double> GasTangents::TakeGrowth(double time) {
  Orthonormalise(time);
  return std::exchange(growth_, std::vector<double>(count_));
}

void GasTangents::MoveBall(int64_t ball, double time) {
  double& last = times_[static_cast<size_t>(ball)];
  const double wait = time - std::exchange(last, time);
  const size_t row = RowOfBall(ball);
  AddTimes(wait, row + 2, row);
  AddTimes(wait, row + 3, row + 1);
}

void GasTangents::MovePiston(int64_t piston, double time) {
  double& last = times_[balls_ + static_cast<size_t>(piston)];
  const size_t row = RowOfPiston(piston);
  AddTimes(time - std::exchange(last, time), row + 1, row);
}

void GasTangents::AddTimes(double time, size_t velocity, size_t position) {
  const double* const from = Row(velocity);
  double* const to = Row(position);
  for (size_t k = 0; k < count_; ++k) to[k] += time * from[k];
}

void GasTangents::ReflectBall(int64_t ball, const GasBall& after) {
  const DiscHit hit(after.position, after.direction, after.speed, rho_);
  const size_t row = RowOfBall(ball);
  double *const x = Row(row), *const y = Row(row + 1);
  double *const vx = Row(row + 2), *const vy = Row(row + 3);
  for (size_t k = 0; k < count_; ++k) hit.Map(x[k], y[k], vx[k], vy[k]);
}

void GasTangents::ReflectPiston(int64_t piston) {
  double* const first = Row(RowOfPiston(piston));
  for (size_t k = 0; k < 2 * count_; ++k) first[k] = -first[k];
}

// Positions and velocities along the piston's axis change places.
void GasTangents::Exchange(const GasEvent& event) {
  const size_t axis = IsAlongX(event.direction) ? 0 : 1;
  const size_t ball = RowOfBall(event.ball) + axis, piston = RowOfPiston(event.piston);
  std::swap_ranges(Row(ball), Row(ball) + count_, Row(piston));
  std::swap_ranges(Row(ball + 2), Row(ball + 2) + count_, Row(piston + 1));
}

// The sums are written out, in one order on every processor: of each vector with all later ones.
void GasTangents::Orthonormalise(double time) {
  hits_ = 0;
  for (size_t ball = 0; ball < balls_; ++ball) MoveBall(static_cast<int64_t>(ball), time);
  for (size_t i = 0; i < pistons_; ++i) MovePiston(static_cast<int64_t>(i), time);
  for (size_t k = 0; k < count_; ++k) {
    std::fill(shares_.begin() + static_cast<std::ptrdiff_t>(k), shares_.end(), 0.0);
    for (size_t i = 0; i < vector_.size(); ++i) {
      const double* const row = Row(i);
      vector_[i] = row[k];
      for (size_t j = k; j < count_; ++j) shares_[j] += row[k] * row[j];
    }
    const double squared = shares_[k], length = std::sqrt(squared);
    growth_[k] += Log(length);
    for (size_t i = 0; i < vector_.size(); ++i) {
      double* const row = Row(i);
      const double component = vector_[i] / squared;
      for (size_t j = k + 1; j < count_; ++j) row[j] -= component * shares_[j];
      row[k] = vector_[i] / length;
    }
  }
}

// The projections across w of all velocities but the one along which w is largest.
std::vector<GasTangents::Vector> VelocitiesAcross(const GasGeometry& geometry,
                                                  const GasState& state) {
  const auto w = VelocitiesOf(state);
  const auto largest = std::ranges::max_element(
      w, {}, [](const auto& velocity) { return std::fabs(velocity.second); });
  double squared = 0;
  for (const auto& [component, velocity] : w) squared += velocity * velocity;
  std::vector<GasTangents::Vector> vectors;
  for (auto along = w.begin(); along != w.end(); ++along) {
    if (along == largest) continue;
    GasTangents::Vector& vector =
        vectors.emplace_back(GasTangents::Vector(2 * DegreesOfFreedom(geometry)));
    vector[along->first] = 1;
    const double share = along->second / squared;
    for (const auto& [component, velocity] : w) vector[component] -= share * velocity;
  }
  return vectors;
}

}  // namespace ballpiston
