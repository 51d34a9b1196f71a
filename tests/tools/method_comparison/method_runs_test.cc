// Tests the returns, the relaxation times, the currents and the trajectories of the methods.
#include "core/closed_form/mean_free_time.h"
#include "tests/core/preamble.h"
#include "tools/method_comparison/point_runs.h"
#include "tools/method_comparison/returns.h"
#include "tools/method_comparison/trajectory_horizon.h"

namespace ballpiston::method_comparison {
namespace {

constexpr double kEpsilonOfReturns = 0.125;

// The bias of the mean free time at two time steps, a factor of three apart, against the closed
// form: about 12% and 4%, with standard errors of 0.5% and 0.4%. Therefore the standard error of
// the measured order is 0.09. The limit is 4.5 standard errors about 1, with 7e-6 false alarms (the
// seed is fixed). With coarser steps the ball leaves the cell through the tips.
TEST(Returns, TimeIsBiasedToFirstOrderInTheStep) {
  const double exact = ConditionalMeanFreeTime(kPaperPair, kEpsilonOfReturns);
  const auto bias = [&](double step, uint64_t samples) {
    const auto returns =
        RunReturns(FixedSteps(step), kPaperPair, kEpsilonOfReturns, {5, 6}, samples);
    EXPECT_EQ(returns.times.count, samples);
    return std::fabs(returns.times.mean - exact) / exact;
  };
  const double coarse = bias(0.06, 1 << 15), fine = bias(0.02, 1 << 16);
  EXPECT_GT(coarse, 0.08);
  EXPECT_NEAR(std::log(coarse / fine) / std::log(3.0), 1, 4.5 * 0.09);
}

// The wall hits are the cost of a method, so those of orbits that it loses count.
TEST(Returns, WallHitsOfALostOrbitCount) {
  const auto run = [](uint64_t samples) {
    return RunReturns(FixedSteps(0.3), kPaperPair, kEpsilonOfReturns, {5, 6}, samples);
  };
  uint64_t samples = 1;  // until the last one is lost
  while (samples < 1000 && run(samples).times.count == samples) ++samples;
  const auto without = run(samples - 1), with = run(samples);
  ASSERT_EQ(with.times.count, without.times.count) << "no orbit was lost: take a longer step";
  EXPECT_GT(with.wall_hits, without.wall_hits);
}

// A short orbit is the same in all precisions.
TEST(Returns, AllMethodsStartFromTheSameStates) {
  constexpr RandomStream kShort = {21, 214};
  const auto reference = RunReturns(kReference, kPaperPair, kEpsilonOfReturns, kShort, 1);
  ASSERT_GT(reference.wall_hits, 0) << "choose another stream";
  ASSERT_LT(reference.wall_hits, 8) << "choose another stream";
  for (const Method& method :
       {kReferenceSingle, kReferenceLongDouble, kReferenceQuadruple, kLanes, kLanesSingle}) {
    const auto one = RunReturns(method, kPaperPair, kEpsilonOfReturns, kShort, 1);
    EXPECT_NEAR(one.times.mean, reference.times.mean, 1e-3) << method.name;
    EXPECT_EQ(one.wall_hits, reference.wall_hits) << method.name;
  }
}

// ---- point_runs.h ----

const Method kSmallSteps = FixedSteps(2e-3);

const PointRuns kRelaxation = RelaxationRuns(kPaperPair, 5);
const PointRuns kHeatCurrent = HeatCurrentRuns(kPaperRho, 0.2, 7);

TEST(PointRuns, RunsHaveTheRequestedSamplesAndTheSameValueEachTime) {
  for (const auto& [runs, method, samples] :
       std::vector<std::tuple<PointRuns, Method, uint64_t>>{{kRelaxation, kLanes, 64},
                                                            {kRelaxation, kMarkov, 64},
                                                            {kHeatCurrent, kLanes, 256},
                                                            {kHeatCurrent, kReference, 256},
                                                            {kHeatCurrent, kMarkov, 256},
                                                            {kHeatCurrent, kSmallSteps, 16}}) {
    const PointEstimate first = runs.Run(method, samples);
    EXPECT_EQ(first.samples, samples);
    EXPECT_GT(first.seconds, 0);
    EXPECT_EQ(runs.Run(method, samples).value, first.value);
  }
}

TEST(PointRuns, TheTruthHasOtherSamplesThanARun) {
  for (const PointRuns& runs : {kRelaxation, kHeatCurrent}) {
    EXPECT_NE(runs.Truth(512).value, runs.Run(kLanes, 512).value);
  }
}

// A difference of four combined standard errors has 6e-5 false alarms, and the seed is fixed. The
// errors are about 4 %. Small time steps have a bias of 2 %, the limit of 5 %.
TEST(HeatCurrentRuns, AllMethodsAgree) {
  const PointEstimate reference = kHeatCurrent.Run(kReference, 8192);
  EXPECT_LT(reference.error, 0.06 * reference.value);
  for (const auto& [method, samples] : std::vector<std::pair<Method, uint64_t>>{
           {kLanes, 8192}, {kSmallSteps, 64}, {kMarkov, 8192}}) {
    const PointEstimate other = kHeatCurrent.Run(method, samples);
    EXPECT_GT(other.error, 0);
    EXPECT_LT(std::fabs(other.value - reference.value),
              4 * std::hypot(other.error, reference.error))
        << method.name;
  }
}

// With steps of 0.1 a ball crosses a cell in a few steps: all replicas lose their ball.
TEST(HeatCurrentRuns, ReplicasThatLoseABallAreNotCounted) {
  const PointEstimate run = kHeatCurrent.Run(FixedSteps(0.1), 64);
  EXPECT_EQ(run.samples, 0u);
  EXPECT_GT(run.seconds, 0);
}

// ---- trajectory_horizon.h ----

constexpr RandomStream kStreamOfTwins = {31, 7};
constexpr size_t kTwins = 64;

TrajectoryHorizon HorizonOfMethod(const Method& method) {
  TwinOrbits twins(kPaperPair, kStreamOfTwins, kTwins);
  return HorizonOf(method, kPaperPair, twins);
}

double CombinedError(const Moments& a, const Moments& b) {
  return std::hypot(*a.StandardError(), *b.StandardError());
}

// The test compares each precision with the next: H' - H = (bits' - bits) log 2/L, with the
// exponent L per hit from the whole range of precisions. It makes three comparisons at 4.5 combined
// standard errors, with a fixed seed. One in 5e4 seeds would fail.
TEST(TrajectoryHorizon, HorizonGrowsWithTheLogarithmOfThePrecision) {
  const std::pair<Method, int> methods[] = {{kReferenceSingle, 24},
                                            {kReference, 53},
                                            {kReferenceLongDouble, 64},
                                            {kReferenceQuadruple, 113}};
  std::vector<Moments> horizons;
  for (const auto& [method, bits] : methods) horizons.push_back(HorizonOfMethod(method).hits);
  const double hits_of_a_bit = (horizons[3].mean - horizons[0].mean) / (113 - 24);
  // L from displacements of 1e-60 that grow over 60 hits: 1.006 +- 0.004. The slope has an error of
  // 0.005, so the limit is 4.5 standard errors.
  EXPECT_NEAR(std::numbers::ln2 / hits_of_a_bit, 1.006, 0.03);
  for (size_t i = 1; i < 4; ++i) {
    EXPECT_NEAR(horizons[i].mean - horizons[i - 1].mean,
                (methods[i].second - methods[i - 1].second) * hits_of_a_bit,
                4.5 * CombinedError(horizons[i], horizons[i - 1]))
        << methods[i].second << " bits";
  }
}

// A relative error of 1e-16 gives about 32 hits.
TEST(TrajectoryHorizon, LanesPartAfterAsManyHitsAsTheReference) {
  const Moments reference = HorizonOfMethod(kReference).hits, lanes = HorizonOfMethod(kLanes).hits;
  EXPECT_NEAR(reference.mean, 32, 2);
  EXPECT_NEAR(lanes.mean, reference.mean, 1 + 4.5 * CombinedError(lanes, reference));
  const Moments single = HorizonOfMethod(kReferenceSingle).hits,
                lanes_single = HorizonOfMethod(kLanesSingle).hits;
  EXPECT_NEAR(lanes_single.mean, single.mean, 1 + 4.5 * CombinedError(lanes_single, single));
}

}  // namespace
}  // namespace ballpiston::method_comparison
