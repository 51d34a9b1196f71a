#include "core/experiment/steady_group.h"

#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

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
