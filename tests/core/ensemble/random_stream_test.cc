#include "core/ensemble/random_stream.h"

#include "core/experiment/all_experiments.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

uint64_t StreamAt(const ExperimentKind& experiment, const PointParameters& point,
                  Model model = Model::kBilliard) {
  return PointStream({.experiment = &experiment, .model = model}, point);
}

TEST(PointStream, TheJumpProcessHasItsOwnRandomNumbers) {
  const PointParameters point = {{kRho, 0.6}, {kDelta, 0.1}};
  const uint64_t billiard = StreamAt(kEnergyRelaxation, point);
  EXPECT_NE(StreamAt(kEnergyRelaxation, point, Model::kMarkov), billiard);
  EXPECT_EQ(StreamAt(kEnergyRelaxation, point, Model::kBilliardReference), billiard);
}

}  // namespace
}  // namespace ballpiston
