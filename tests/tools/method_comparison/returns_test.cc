#include "tools/method_comparison/returns.h"

#include "core/closed_form/mean_free_time.h"
#include "tests/core/preamble.h"

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

}  // namespace
}  // namespace ballpiston::method_comparison
