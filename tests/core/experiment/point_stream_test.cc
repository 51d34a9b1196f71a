#include "core/experiment/point_stream.h"

#include <gtest/gtest.h>

#include <set>

namespace ballpiston {
namespace {

TEST(PointStream, TellsEveryPointApart) {
  std::set<uint64_t> streams;
  size_t points = 0;
  for (const Experiment experiment :
       {Experiment::kEquilibrium, Experiment::kConditionalMeanFreeTime, Experiment::kFirstHit}) {
    for (int i = 0; i < 1000; ++i) {
      const double x = 0.1 + i * 1e-16;  // neighbouring doubles
      streams.insert(PointStream(experiment, {.rho = x, .delta = 0.1}));
      streams.insert(PointStream(experiment, {.rho = 0.2, .delta = 0.1, .epsilon = i * 0x1p-60}));
      streams.insert(
          PointStream(experiment, {.rho = 0.2, .delta = 0.1, .epsilon = 0.3, .exponent = i / 7.0}));
      points += 3;
    }
  }
  // Steps of 1e-16 around 0.1 hit each double up to once.
  EXPECT_GE(streams.size(), points - 3 * 150);
}

TEST(PointStream, AbsentDiffersFromZeroAndZerosAreEqual) {
  const auto of = [](std::optional<double> epsilon) {
    return PointStream(Experiment::kFirstHit, {.rho = 0.6, .delta = 0.1, .epsilon = epsilon});
  };
  EXPECT_NE(of({}), of(0.0));
  EXPECT_EQ(of(-0.0), of(0.0));
}

// Results carry these bits: a change of the hash needs a new engine version.
TEST(PointStream, StaysAsItIs) {
  EXPECT_EQ(PointStream(Experiment::kFirstHit,
                        {.rho = 0.6, .delta = 0.1, .epsilon = 0.125, .exponent = 5}),
            0x9db217c23f7c2fb5u);
}

}  // namespace
}  // namespace ballpiston
