#include "core/experiment/steady_group.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace ballpiston {
namespace {

// More have no exact number. A damaged state may have any.
constexpr double kMostWindows = 0x1p53;

// Calls visit(number) for all numbers of a group, in the order in which they are stored. The
// numbers may be changed.
template <typename Visit>
class GroupNumbers {
 public:
  GroupNumbers(const SteadyShape& shape, Visit visit) : shape_(shape), visit_(std::move(visit)) {}

  void Of(SteadyGroup& group) {
    visit_(group.stretches);
    visit_(group.measured);
    for (Moments& windows : group.windows) Of(windows);
    for (SteadyTrajectory& trajectory : group.trajectories) Of(trajectory);
  }

 private:
  void Of(Moments& moments) {
    auto count = static_cast<double>(moments.count);
    visit_(count);
    moments.count = static_cast<uint64_t>(std::clamp(count, 0.0, kMostWindows));
    for (double* const sum : {&moments.mean, &moments.m2, &moments.m3, &moments.m4}) visit_(*sum);
  }

  void Of(SteadyTrajectory& trajectory) {
    visit_(trajectory.energy);
    for (double& sum : trajectory.sums) visit_(sum);
    for (double& half : trajectory.halves) visit_(half);
    for (GasBall& ball : trajectory.state.balls) Of(ball);
    for (GasPiston& piston : trajectory.state.pistons) {
      if (shape_.has_positions) visit_(piston.offset);
      visit_(piston.velocity);
    }
  }

  // Position and velocity.
  void Of(GasBall& ball) {
    if (!shape_.has_positions) return visit_(ball.speed);
    visit_(ball.position.x());
    visit_(ball.position.y());
    Eigen::Vector2d velocity = ball.speed * ball.direction;
    visit_(velocity.x());
    visit_(velocity.y());
    ball.speed = std::sqrt(velocity.squaredNorm());
    if (ball.speed > 0) ball.direction = velocity / ball.speed;
  }

  const SteadyShape& shape_;
  Visit visit_;
};

}  // namespace

// A window of length i ends when the windows of all smaller lengths have ended for the second time
// since the last one ended: as the digits of a binary counter.
void SteadyGroup::AddStretch(const std::vector<double>& charges) {
  const auto before = static_cast<uint64_t>(measured);
  for (size_t i = 0; i < charges.size(); ++i) {
    std::array<double, kWindowLengths>& halves = trajectories[i].halves;
    double charge = charges[i];
    for (size_t length = 0; length < kWindowLengths; ++length) {
      windows[length].Add(charge);
      const bool is_second_half = (before >> length & 1) != 0;
      if (!is_second_half) {
        halves[length] = charge;
        break;
      }
      charge += halves[length];
    }
  }
  ++measured;
}

SteadyGroup SteadyShape::NewGroup() const {
  SteadyTrajectory trajectory = {.sums = std::vector<double>(quantities)};
  trajectory.state.balls.resize(balls);
  trajectory.state.pistons.resize(pistons);
  return {.trajectories = std::vector<SteadyTrajectory>(trajectories, trajectory)};
}

size_t SteadyShape::Numbers() const {
  constexpr size_t kOfMoments = 5;
  const size_t of_the_state = has_positions ? 4 * balls + 2 * pistons : balls + pistons;
  return 2 + kOfMoments * kWindowLengths +
         trajectories * (1 + quantities + kWindowLengths + of_the_state);
}

GroupState SteadyShape::Written(SteadyGroup group) const {
  std::vector<double> numbers;
  numbers.reserve(Numbers());
  GroupNumbers(*this, [&](double number) { numbers.push_back(number); }).Of(group);
  return GroupState(std::move(numbers));
}

SteadyGroup SteadyShape::Read(const GroupState& state) const {
  SteadyGroup group = NewGroup();
  const double* next = state.numbers().data();
  GroupNumbers(*this, [&](double& number) { number = *next++; }).Of(group);
  return group;
}

}  // namespace ballpiston
