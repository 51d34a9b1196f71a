#include "tools/method_comparison/point_runs.h"

#include "tests/core/preamble.h"

namespace ballpiston::method_comparison {
namespace {

const Method kSmallSteps = FixedSteps(2e-3);

EnergyRelaxationRuns Relaxation(double delta) { return {PaperGeometry(delta), 5}; }
HeatCurrentRuns HeatCurrent(double delta) { return {kPaperRho, delta, 7}; }

template <typename Runs>
void ExpectRunsHaveTheRequestedSamples(const Runs& runs, const Method& method, uint64_t samples) {
  const PointEstimate first = runs.Run(method, samples);
  EXPECT_EQ(first.samples, samples);
  EXPECT_GT(first.seconds, 0);
  EXPECT_EQ(runs.Run(method, samples).value, first.value);
}

TEST(PointRuns, RunsHaveTheRequestedSamplesAndTheSameValueEachTime) {
  for (const Method& method : {kLanes, kMarkov}) {
    ExpectRunsHaveTheRequestedSamples(Relaxation(0.2), method, 64);
  }
  for (const Method& method : {kLanes, kReference, kMarkov}) {
    ExpectRunsHaveTheRequestedSamples(HeatCurrent(0.2), method, 256);
  }
  ExpectRunsHaveTheRequestedSamples(HeatCurrent(0.2), kSmallSteps, 16);
}

TEST(PointRuns, TheTruthHasOtherSamplesThanARun) {
  EXPECT_NE(Relaxation(0.2).Truth(512).value, Relaxation(0.2).Run(kLanes, 512).value);
  EXPECT_NE(HeatCurrent(0.2).Truth(512).value, HeatCurrent(0.2).Run(kLanes, 512).value);
}

// A difference of four combined standard errors has 6e-5 false alarms, and the seed is fixed. The
// errors are about 4 %. Small time steps have a bias of 2 %, the limit of 5 %.
TEST(HeatCurrentRuns, AllMethodsAgree) {
  const HeatCurrentRuns runs = HeatCurrent(0.2);
  const PointEstimate reference = runs.Run(kReference, 8192);
  EXPECT_LT(reference.error, 0.06 * reference.value);
  for (const auto& [method, samples] : std::vector<std::pair<Method, uint64_t>>{
           {kLanes, 8192}, {kSmallSteps, 64}, {kMarkov, 8192}}) {
    const PointEstimate other = runs.Run(method, samples);
    EXPECT_GT(other.error, 0);
    EXPECT_LT(std::fabs(other.value - reference.value),
              4 * std::hypot(other.error, reference.error))
        << method.name;
  }
}

// With steps of 0.1 a ball crosses a cell in a few steps: all replicas lose their ball.
TEST(HeatCurrentRuns, ReplicasThatLoseABallAreNotCounted) {
  const PointEstimate run = HeatCurrent(0.2).Run(FixedSteps(0.1), 64);
  EXPECT_EQ(run.samples, 0u);
  EXPECT_GT(run.seconds, 0);
}

}  // namespace
}  // namespace ballpiston::method_comparison
