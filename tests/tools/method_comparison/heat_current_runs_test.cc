#include "tests/core/preamble.h"
#include "tools/method_comparison/point_runs.h"

namespace ballpiston::method_comparison {
namespace {

constexpr MethodVariant kSmallSteps = {Method::kFixedStep, 2e-3};

HeatCurrentRuns Runs(double delta) { return {kPaperRho, delta, 7}; }

// The difference in units of the combined standard error.
double Off(const PointEstimate& a, const PointEstimate& b) {
  return std::fabs(a.value - b.value) / std::hypot(a.error, b.error);
}

TEST(HeatCurrentRuns, RunsHaveTheRequestedReplicasAndOtherReplicasGiveOtherValues) {
  const HeatCurrentRuns runs = Runs(0.2);
  for (const MethodVariant& variant : std::vector<MethodVariant>{
           {Method::kLanes}, {Method::kReference}, {Method::kMarkov}, kSmallSteps}) {
    const PointEstimate run = runs.Run(variant, RunOf(64));
    EXPECT_EQ(run.samples, 64u);
    EXPECT_GT(run.seconds, 0);
    EXPECT_GT(run.error, 0);
    EXPECT_EQ(run.value, runs.Run(variant, RunOf(64)).value);
    EXPECT_NE(run.value, runs.Run(variant, TruthOf(64)).value);
  }
}

// A difference of four combined standard errors has 6e-5 false alarms, and the seed is fixed. The
// errors are about 4 %. Small time steps have a bias of 2 %, the limit of 5 %.
TEST(HeatCurrentRuns, AllMethodsAgree) {
  const HeatCurrentRuns runs = Runs(0.2);
  const PointEstimate reference = runs.Run({Method::kReference}, RunOf(256));
  EXPECT_LT(reference.error, 0.06 * reference.value);
  EXPECT_LT(Off(runs.Run({Method::kLanes}, TruthOf(256)), reference), 4);
  EXPECT_LT(Off(runs.Run(kSmallSteps, TruthOf(64)), reference), 4);
  EXPECT_LT(Off(runs.Run({Method::kMarkov}, TruthOf(256)), reference), 4);
}

// With steps of 0.1 a ball crosses a cell in a few steps: all replicas lose their ball.
TEST(HeatCurrentRuns, ReplicasThatLoseABallAreNotCounted) {
  const PointEstimate run = Runs(0.2).Run({Method::kFixedStep, 0.1}, RunOf(64));
  EXPECT_EQ(run.samples, 0u);
  EXPECT_GT(run.seconds, 0);
}

TEST(HeatCurrentRuns, SmallerStepsAndRarerCollisionsCostMore) {
  const auto predicted = [](double delta, const MethodVariant& variant) {
    return Runs(delta).PredictedSecondsPerReplica(variant);
  };
  EXPECT_NEAR(predicted(0.2, {Method::kFixedStep, 1e-3}),
              10 * predicted(0.2, {Method::kFixedStep, 1e-2}), 1e-9);
  for (const Method method : {Method::kLanes, Method::kReference}) {
    EXPECT_GT(predicted(0.05, {method}), 3 * predicted(0.2, {method}));
  }
  EXPECT_NEAR(predicted(0.05, {Method::kMarkov}) / predicted(0.2, {Method::kMarkov}), 1, 0.1);
}

}  // namespace
}  // namespace ballpiston::method_comparison
