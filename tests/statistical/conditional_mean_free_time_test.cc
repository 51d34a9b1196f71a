// Return times at fixed energies: their errors.
#include "core/billiard/billiard_domain.h"
#include "tests/core/asked.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

// The tolerance is judged at doubling numbers of samples. This rarely stops too early by chance, so
// the stated error stays valid. Of 10,000 seeds 69.6 % were within one stated error and 95.3 %
// within two. With 500 seeds the standard errors of these shares are 2.1 % and 0.95 %. The nightly
// test has 2,000 seeds and half these errors. The windows are four errors wide on either side:
// 1.3e-4 false alarms in all. If the stated error were 20 % too small, 57.6 % would be within one
// and 89.0 % within two; if it were 10 % too small, 63.2 % and 92.8 %.
TEST(ConditionalMeanFreeTime, ErrorsAreValidWhenAToleranceStops) {
  const uint64_t seeds = IsNightly() ? 2000 : 500;
  double within_one = 0, within_two = 0;
  EnsembleSpec spec =
      Asked("conditional-mean-free-time delta=0.05 epsilon=0.25 tolerance=0.02 model=billiard");
  for (spec.seed = 0; spec.seed < seeds; ++spec.seed) {
    const double z = std::fabs(*RunPoint(spec).estimates[0].ZScore());
    within_one += z <= 1;
    within_two += z <= 2;
  }
  const auto count = static_cast<double>(seeds);
  EXPECT_NEAR(within_one / count, 0.6827, 4 * std::sqrt(0.6827 * 0.3173 / count));
  EXPECT_NEAR(within_two / count, 0.9545, 4 * std::sqrt(0.9545 * 0.0455 / count));
}

// Narrow tips, wide tips, and a cell so small that rounding matters most. The windows are the
// stated error plus 4 standard errors: 6e-5 false alarms each. Standard errors are 0.1 to 0.2 %,
// nightly 0.07 to 0.14 %.
TEST(ConditionalMeanFreeTime, SinglePrecisionIsWithinItsStatedError) {
  for (const double rho : {0.501, 0.65, kSingleDomain.max_rho}) {
    const PointParameters point = {{kRho, rho}, {kDelta, PairDeltaBound(rho)}, {kEpsilon, 0.45}};
    EnsembleSpec spec = SpecOf(&kConditionalMeanFreeTime, point,
                               {.samples = IsNightly() ? 1'000'000 : 500'000}, Model::kBilliard, 6);
    spec.precision = Precision::kSingle;
    ASSERT_TRUE(Violations(spec).empty());
    const PointSummary summary = RunPoint(spec);
    const Estimate& time = summary.estimates[0];
    const double off = time.value / *time.exact - 1, error = *time.standard_error / *time.exact;
    EXPECT_LT(std::fabs(off), kSinglePrecisionError + 4 * error) << rho;
    EXPECT_EQ(summary.health.escapes, 0u);
  }
}

}  // namespace
}  // namespace ballpiston
