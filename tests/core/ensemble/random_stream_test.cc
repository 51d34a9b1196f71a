#include "core/ensemble/random_stream.h"

#include "core/experiment/all_experiments.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

uint64_t StreamAt(const ExperimentKind& experiment, const PointParameters& point,
                  Model model = Model::kBilliard, Purpose purpose = Purpose::kAnswer) {
  return PointStream({.experiment = &experiment, .model = model, .purpose = purpose}, point);
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

}  // namespace
}  // namespace ballpiston
