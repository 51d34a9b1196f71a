#include "core/experiment/steady_group.h"

#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

SteadyGroup SomeGroup(const SteadyShape& shape) {
  SteadyGroup group = shape.NewGroup();
  double number = 0.1;
  const auto next = [&] { return number = std::fmod(number * 1.7 + 0.3, 1); };
  group.stretches = 7;
  for (SteadyTrajectory& trajectory : group.trajectories) {
    trajectory.energy = next();
    for (double& sum : trajectory.sums) sum = next();
    for (GasBall& ball : trajectory.state.balls) {
      ball.speed = next();
      if (!shape.has_positions) continue;
      const double angle = next();
      ball.position = {next(), next()};
      ball.direction = {std::cos(angle), std::sin(angle)};
    }
    for (GasPiston& piston : trajectory.state.pistons) {
      piston.velocity = -next();
      if (shape.has_positions) piston.offset = next();
    }
  }
  for (int i = 0; i < 5; ++i) group.AddStretch({next(), next()});
  return group;
}

TEST(SteadyGroup, AGroupIsReadAsItWasWritten) {
  for (const bool has_positions : {true, false}) {
    const SteadyShape shape = {.trajectories = 2,
                               .quantities = 3,
                               .balls = 2,
                               .pistons = 3,
                               .has_positions = has_positions};
    const SteadyGroup group = SomeGroup(shape);
    const GroupState written = shape.Written(group);
    ASSERT_EQ(written.numbers().size(), shape.Numbers());
    const SteadyGroup read = shape.Read(written);
    EXPECT_EQ(read.stretches, 7);
    EXPECT_EQ(read.measured, 5);
    EXPECT_EQ(read.windows, group.windows);
    for (size_t i = 0; i < 2; ++i) {
      const SteadyTrajectory &a = read.trajectories[i], &b = group.trajectories[i];
      EXPECT_EQ(a.energy, b.energy);
      EXPECT_EQ(a.sums, b.sums);
      EXPECT_EQ(a.halves, b.halves);
      // Velocities are written: speed and direction are rounded.
      const std::vector<double> found = ComponentsOf(a.state), expected = ComponentsOf(b.state);
      ASSERT_EQ(found.size(), expected.size());
      for (size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-15);
    }
  }
}

TEST(SteadyGroup, WindowsHoldTheWholeCharge) {
  const SteadyShape shape = {.trajectories = 2, .balls = 1, .pistons = 2};
  SteadyGroup group = shape.NewGroup();
  std::vector<double> charges;
  for (int i = 0; i < 13; ++i) {
    charges.push_back(i * i);
    group.AddStretch({charges.back(), 0});
    group = shape.Read(shape.Written(group));  // windows may begin in one chunk and end in another
  }
  for (size_t length = 0; length < 5; ++length) {
    const size_t stretches = size_t{1} << length, windows = charges.size() / stretches;
    Moments expected;
    for (size_t i = 0; i < windows; ++i) {
      const auto first = charges.begin() + static_cast<std::ptrdiff_t>(i * stretches);
      expected.Add(std::accumulate(first, first + static_cast<std::ptrdiff_t>(stretches), 0.0));
      expected.Add(0);
    }
    EXPECT_EQ(group.windows[length], expected) << length;
  }
}

}  // namespace
}  // namespace ballpiston
