#include "core/ensemble/random_stream.h"

#include "core/experiment/all_experiments.h"
#include "tests/core/preamble.h"

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
      const double x = std::bit_cast<double>(std::bit_cast<uint64_t>(0.1) + i);
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
  EXPECT_EQ(streams.size(), points);
}

TEST(PointStream, ParametersWithTheSameValueDiffer) {
  const PointParameters pair = {{kRho, 0.6}, {kDelta, 0.1}};
  std::set<uint64_t> streams = {StreamAt(kFirstHit, pair)};  // an absent value is not zero
  for (const Parameter* parameter : {&kEpsilon, &kCells, &kTemperature, &kHot, &kCold}) {
    for (const double value : {0, 1}) {
      streams.insert(StreamAt(kFirstHit, {{kRho, 0.6}, {kDelta, 0.1}, {*parameter, value}}));
    }
  }
  EXPECT_EQ(streams.size(), 11u);
  EXPECT_EQ(StreamAt(kFirstHit, {{kRho, 0.6}, {kDelta, 0.1}, {kEpsilon, -0.0}}),
            StreamAt(kFirstHit, {{kRho, 0.6}, {kDelta, 0.1}, {kEpsilon, 0.0}}));
}

TEST(PointStream, PilotAndJumpProcessHaveTheirOwnRandomNumbers) {
  const PointParameters point = {{kRho, 0.6}, {kDelta, 0.1}};
  const uint64_t billiard = StreamAt(kEnergyRelaxation, point);
  const std::set<uint64_t> streams = {
      billiard, StreamAt(kEnergyRelaxation, point, Model::kMarkov),
      StreamAt(kEnergyRelaxation, point, Model::kBilliard, Purpose::kPilot)};
  EXPECT_EQ(streams.size(), 3u);
  EXPECT_EQ(StreamAt(kEnergyRelaxation, point, Model::kBilliardReference), billiard);
}

// Results carry these bits: a change of the hash needs a new engine version.
TEST(PointStream, HashIsUnchanged) {
  EXPECT_EQ(StreamAt(kFirstHit, {{kRho, 0.6}, {kDelta, 0.1}, {kEpsilon, 0.125}, {kExponent, 5}}),
            0xc32990bea278da20u);
}

}  // namespace
}  // namespace ballpiston
