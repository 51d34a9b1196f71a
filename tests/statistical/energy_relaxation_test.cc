// Relaxation of the energy: the jump process is compared with the spectrum, the billiard with both.
//
// Values at different lags come from the same orbits and are correlated. So a curve, at every other
// lag, is compared by Hotelling's T^2, which generalises chi^2 to correlated numbers. The
// covariance is that of the means of some hundred independent blocks. If single lags are compared,
// the largest of n scores is above 4.5 in at most n times 6.8e-6 of all cases, for all correlations
// (Bonferroni).
#include "core/experiment/energy_relaxation.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/point_experiment.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

// Every other lag, from `first` on.
template <typename ValueAt>
Eigen::VectorXd Thinned(size_t first, ValueAt value_at) {
  Eigen::VectorXd values(static_cast<Eigen::Index>((kLags - first + 1) / 2));
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    values[i] = value_at(first + 2 * static_cast<size_t>(i));
  }
  return values;
}

struct Blocks {
  PointSummary summary;
  std::vector<Eigen::VectorXd> curves;  // one for each block
};

// Runs `blocks` blocks of the jump process at delta = 0.1, each of `orbits` orbits.
Blocks RunInBlocks(uint64_t blocks, uint64_t orbits, size_t first_lag,
                   std::optional<double> epsilon = {}) {
  const auto point = PointExperiment::Create(
      SpecOf(&kEnergyRelaxation, PaperPoint(0.1, epsilon), {.tolerance = 1e-6}, Model::kMarkov, 2),
      0);
  BlockResult merged;
  Blocks result;
  for (uint64_t i = 0; i < blocks; ++i) {
    const BlockResult block = RunBlock(*point, {.first = i * orbits, .samples = orbits});
    merged.Merge(block);
    result.curves.push_back(
        Thinned(first_lag, [&](size_t lag) { return block.moments[1 + lag].mean; }));
  }
  result.summary = point->Summarize(merged);
  return result;
}

Eigen::VectorXd LimitOf(const Curve& curve, size_t first_lag) {
  return Thinned(first_lag, [&](size_t lag) { return *curve.points[lag].limit; });
}

// T^2 of the curves' mean from `expected`, as the normal variable of the same probability (Wilson
// and Hilferty): above 4 in 3e-5 of all cases. Of n lags and m curves, T^2 (m - n)/((m - 1) n) has
// the law F(n, m - n).
double HotellingScore(const std::vector<Eigen::VectorXd>& curves, const Eigen::VectorXd& expected) {
  const Eigen::Index lags = expected.size();
  const auto m = static_cast<double>(curves.size()), n = static_cast<double>(lags);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(lags);
  for (const Eigen::VectorXd& curve : curves) mean += curve / m;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(lags, lags);
  for (const Eigen::VectorXd& curve : curves) {
    covariance += (curve - mean) * (curve - mean).transpose() / (m - 1);
  }
  const Eigen::VectorXd off = mean - expected;
  const double square = m * off.dot(covariance.ldlt().solve(off));
  const double f = square * (m - n) / ((m - 1) * n);
  const double root = std::cbrt(f), a = 2 / (9 * n), b = 2 / (9 * (m - n));
  return (root * (1 - b) - (1 - a)) / std::sqrt(a + root * root * b);
}

double LargestScore(const Curve& curve, size_t first) {
  double largest = 0;
  for (size_t i = first; i < curve.points.size(); ++i) {
    const CurvePoint& point = curve.points[i];
    largest =
        std::max(largest, std::fabs(point.value - *point.limit) / point.standard_error.value());
  }
  return largest;
}

// Half a million orbits, 20 million jumps; nightly four times as many. False alarms: 3e-5 for the
// curve, 33 * 6.8e-6 for the lags, 6e-5 for the integral; 3e-4 in all.
TEST(EnergyRelaxation, AutocorrelationOfTheJumpProcessMatchesTheSpectrum) {
  const double smallest = IsNightly() ? 1e-3 : 2e-3;
  const Blocks blocks = RunInBlocks(IsNightly() ? 512 : 128, 4096, 0);
  const PointSummary& summary = blocks.summary;
  const Curve& curve = summary.curves.front();
  EXPECT_GT(curve.points.front().value, 0.99);
  // Down to `smallest` every point differs from zero by more than five standard errors.
  EXPECT_LT(*curve.points.back().limit, 1e-3);
  for (const CurvePoint& point : curve.points) {
    EXPECT_TRUE(*point.limit < smallest || point.value > 5 * *point.standard_error) << point.at;
  }
  const Eigen::VectorXd limit = LimitOf(curve, 0);
  const double score = HotellingScore(blocks.curves, limit);
  const Estimate& time = summary.estimates.front();
  EXPECT_LT(score, 4);
  EXPECT_LT(LargestScore(curve, 0), 4.5);
  EXPECT_LT(std::fabs(*time.ZScore()), 4);
  EXPECT_LT(*time.standard_error, smallest * time.value);
  // The test detects a law with times that are 1 % shorter, nightly 0.5 %.
  const double shorter = IsNightly() ? 0.005 : 0.01;
  EXPECT_GT(HotellingScore(blocks.curves, limit.array().pow(1 + shorter)), 10);
}

// The same rates of false alarms, twice. At lag 0 the energy is given.
TEST(EnergyRelaxation, MeanEnergyOfTheJumpProcessMatchesTheSpectrum) {
  for (const double epsilon : {0.01, 0.4}) {
    const Blocks blocks = RunInBlocks(128, IsNightly() ? 16384 : 8192, 2, epsilon);
    const PointSummary& summary = blocks.summary;
    const Curve& curve = summary.curves.front();
    EXPECT_NEAR(curve.points[0].value, epsilon, 1e-12);
    const Eigen::VectorXd limit = LimitOf(curve, 2);
    const double score = HotellingScore(blocks.curves, limit);
    const Estimate& time = summary.estimates.front();
    EXPECT_LT(score, 4) << epsilon;
    EXPECT_LT(LargestScore(curve, 1), 4.5);
    EXPECT_LT(std::fabs(*time.ZScore()), 4);
    // The test detects a curve that is 3 % nearer to its end, nightly 2 %.
    const double share = IsNightly() ? 0.02 : 0.03;
    const Eigen::VectorXd nearer = (1 - share) * limit.array() + share * kMeanPistonEnergy;
    EXPECT_GT(HotellingScore(blocks.curves, nearer), 5);
  }
}

// Slow pistons return after a fixed period: 4.9 % +- 0.1 % was measured with 4 million orbits.
// Windows of 4 errors of both: 6e-5.
TEST(EnergyRelaxation, BilliardIsSlowerThanTheLimitAtLargeDelta) {
  const Target orbits = {.samples = IsNightly() ? 200'000 : 100'000};
  const EnsembleSpec spec =
      SpecOf(&kEnergyRelaxation, PaperPoint(0.2), orbits, Model::kBilliard, 2);
  const Estimate time = RunPoint(spec).estimates.front();
  const double difference = time.value / *time.limit - 1,
               error = *time.standard_error / *time.limit;
  EXPECT_GT(difference, 10 * error);
  EXPECT_NEAR(difference, 0.049, 4 * std::hypot(error, 0.001));
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
