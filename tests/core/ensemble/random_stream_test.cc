#include "core/ensemble/random_stream.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <set>

#include "core/experiment/all_experiments.h"

namespace ballpiston {
namespace {

uint64_t StreamAt(const ExperimentKind& experiment, const PointParameters& point,
                  Model model = Model::kBilliard, Purpose purpose = Purpose::kAnswer) {
  return PointStream({.experiment = &experiment, .model = model, .purpose = purpose}, point);
}

TEST(PointStream, StreamsOfAllPointsDiffer) {
  std::set<uint64_t> streams;
  size_t points = 0;
  for (const ExperimentKind* experiment : kAllExperiments) {
    for (int i = 0; i < 1000; ++i) {
      const double x = 0.1 + i * 1e-16;  // neighbouring doubles
      const PointParameters pair = {{kRho, 0.2}, {kDelta, 0.1}};
      PointParameters at_energy = pair, outgoing = pair;
      at_energy.Set(kEpsilon, i * 0x1p-60);
      outgoing.Set(kEpsilon, 0.3);
      outgoing.Set(kExponent, i / 7.0);
      streams.insert(StreamAt(*experiment, {{kRho, x}, {kDelta, 0.1}}));
      streams.insert(StreamAt(*experiment, at_energy));
      streams.insert(StreamAt(*experiment, outgoing));
      points += 3;
    }
  }
  // Steps of 1e-16 around 0.1 hit each double up to once.
  EXPECT_GE(streams.size(), points - 5 * 150);
}

TEST(PointStream, AbsentDiffersFromZeroAndZerosAreEqual) {
  const auto of = [](std::optional<double> epsilon) {
    return StreamAt(kFirstHit, {{kRho, 0.6}, {kDelta, 0.1}, {kEpsilon, epsilon}});
  };
  EXPECT_NE(of({}), of(0.0));
  EXPECT_EQ(of(-0.0), of(0.0));
}

TEST(PointStream, EqualValuesOfDifferentParametersDiffer) {
  std::set<uint64_t> streams;
  for (const Parameter* parameter : {&kEpsilon, &kCells, &kTemperature, &kHot, &kCold}) {
    streams.insert(StreamAt(kFirstHit, {{kRho, 0.6}, {kDelta, 0.1}, {*parameter, 1}}));
  }
  EXPECT_EQ(streams.size(), 5u);
}

TEST(PointStream, PilotAndJumpProcessHaveTheirOwnRandomNumbers) {
  const PointParameters point = {{kRho, 0.6}, {kDelta, 0.1}};
  const uint64_t billiard = StreamAt(kEnergyRelaxation, point);
  const uint64_t walk = StreamAt(kEnergyRelaxation, point, Model::kMarkov);
  const uint64_t pilot = StreamAt(kEnergyRelaxation, point, Model::kBilliard, Purpose::kPilot);
  EXPECT_EQ(StreamAt(kEnergyRelaxation, point, Model::kBilliardReference), billiard);
  EXPECT_NE(walk, billiard);
  EXPECT_NE(pilot, billiard);
  EXPECT_NE(pilot, walk);
}

// Results carry these bits: a change of the hash needs a new engine version.
TEST(PointStream, HashIsUnchanged) {
  EXPECT_EQ(StreamAt(kFirstHit, {{kRho, 0.6}, {kDelta, 0.1}, {kEpsilon, 0.125}, {kExponent, 5}}),
            0xc32990bea278da20u);
}

}  // namespace
}  // namespace ballpiston
