// Relaxation of the energy: the jump process is compared with the spectrum, the billiard with both.
//
// Values at different lags come from the same orbits and are correlated. The largest of n scores is
// above 4.5 in at most n times 6.8e-6 of all cases, for all correlations (Bonferroni).
#include "core/experiment/energy_relaxation.h"

#include "core/closed_form/mean_free_time.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

// Half a million orbits, 20 million jumps; nightly four times as many. False alarms: 33 * 6.8e-6
// for the lags, 6e-5 for the integral; 3e-4 in all.
TEST(EnergyRelaxation, AutocorrelationOfTheJumpProcessMatchesTheSpectrum) {
  const double smallest = IsNightly() ? 1e-3 : 2e-3;
  const Target walks = {.samples = IsNightly() ? 1 << 21 : 1 << 19};
  const PointSummary summary =
      RunPoint(SpecOf(&kEnergyRelaxation, PaperPoint(0.1), walks, Model::kMarkov, 2));
  const Curve& curve = summary.curves.front();
  EXPECT_GT(curve.points.front().value, 0.99);
  // Down to `smallest` every point differs from zero by more than five standard errors.
  EXPECT_LT(*curve.points.back().limit, 1e-3);
  for (const CurvePoint& point : curve.points) {
    EXPECT_TRUE(*point.limit < smallest || point.value > 5 * *point.standard_error) << point.at;
    EXPECT_LT(std::fabs(point.value - *point.limit) / point.standard_error.value(), 4.5)
        << point.at;
  }
  // The integral detects times that are 1 % shorter, nightly 0.5 %.
  const Estimate& time = summary.estimates.front();
  EXPECT_LT(std::fabs(*time.ZScore()), 4);
  EXPECT_LT(*time.standard_error, smallest * time.value);
}

// Slow pistons return after a fixed period: 4.9 % +- 0.1 % was measured with 4 million orbits.
// Windows of 4 errors of both: 6e-5.
TEST(EnergyRelaxation, BilliardIsSlowerThanTheLimitAtLargeDelta) {
  const EnsembleSpec spec =
      SpecOf(&kEnergyRelaxation, PaperPoint(0.2), {.samples = 100'000}, Model::kBilliard, 2);
  const Estimate time = RunPoint(spec).estimates.front();
  const double error = *time.standard_error / *time.limit;
  EXPECT_LT(error, 0.0049);
  EXPECT_NEAR(time.value / *time.limit, 1.049, 4 * std::hypot(error, 0.001));
}

// The master equation's solution, from initial energies at which an expansion only in
// eigenfunctions had errors of percents in some bins: relative entropies of half a
// million walks (nightly 3 million) within 4.5 errors, a false alarm in 12,000 seeds.
TEST(EnergyRelaxation, LawsOfManyWalksSolveTheMasterEquation) {
  const int64_t walks = IsNightly() ? 3'000'000 : 500'000;
  for (const double epsilon : {0.1, 0.4}) {
    const PointParameters point = PaperPoint(0.1, epsilon);
    const PointSummary summary =
        RunPoint(SpecOf(&kEnergyRelaxation, point, {.samples = walks}, Model::kMarkov));
    const auto expected = kEnergyRelaxation.expected_probabilities(point);
    for (size_t i = 0; i < expected.size(); ++i) {
      const KlDivergence distance =
          RelativeEntropy(summary.histograms[i].histogram.counts, expected[i]);
      const double z = (distance.value - distance.noise_floor) / distance.noise_error;
      EXPECT_LT(std::fabs(z), 4.5) << epsilon << " at " << *summary.histograms[i].time;
      EXPECT_NEAR(*summary.histograms[i].time / MeanFreeTimesOf(PaperGeometry(0.1)).ball_piston,
                  0.25 * static_cast<double>(kLawLags[i]), 1e-8);
    }
  }
}

}  // namespace
}  // namespace ballpiston
