// Compares both engines with all closed forms that exist, the lanes with first hits of an
// independent program, and the engines with each other.
#include "core/billiard/billiard_domain.h"
#include "core/experiment/expected_returns.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/oracle/reference_table.h"
#include "tests/oracle/samples.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

constexpr uint64_t kSeedOfEngines = 9;

// `samples` is the nightly size. The reference has a tenth of the samples, because it takes some
// ten times as long.
int64_t SamplesBy(Model model, int64_t samples) {
  const int64_t by_lanes = IsNightly() ? samples : samples / 3;
  return model == Model::kBilliardReference ? by_lanes / 10 : by_lanes;
}

// The estimates with an exact value, of which there are `count`: within 4.5 standard errors, 7e-6
// false alarms a comparison.
void ExpectExactMeans(const PointSummary& summary, int count) {
  EXPECT_EQ(summary.health.escapes, 0u);
  int compared = 0;
  for (const Estimate& estimate : summary.estimates) {
    if (!estimate.exact) continue;
    ++compared;
    if (const auto z = estimate.ZScore()) {
      EXPECT_LT(std::fabs(*z), 4.5) << estimate.name;
    } else {
      EXPECT_EQ(estimate.value, estimate.exact) << estimate.name;  // a value without scatter
    }
  }
  EXPECT_EQ(compared, count);
}

struct RadiusAndShare {
  double rho;
  double share;  // delta as a fraction of its bound
};

class EngineAtGeometry : public testing::TestWithParam<std::tuple<Model, RadiusAndShare>> {
 protected:
  Model model() const { return std::get<Model>(GetParam()); }
  PointParameters point() const {
    const auto [rho, share] = std::get<RadiusAndShare>(GetParam());
    return {{kRho, rho}, {kDelta, share * PairDeltaBound(rho)}};
  }
};

// Three means in equilibrium and three at each of six energies: 462 comparisons in all, one false
// alarm in 300 choices of the seed. The invariant law is its own ingoing law at every delta: each
// divergence is noise, within 4 errors of its floor: 132 of them, one false alarm in 120 choices.
TEST_P(EngineAtGeometry, MeansAndIngoingLawsMatchTheClosedForms) {
  const Target collisions = {.collisions = SamplesBy(model(), 200'000)};
  ExpectExactMeans(RunPoint(SpecOf(&kEquilibrium, point(), collisions, model(), kSeedOfEngines)),
                   3);
  const Target samples = {.samples = SamplesBy(model(), 200'000)};
  // At epsilon = 1/2 the ball rests, and the mean is over the part of the volume that is visited.
  for (const double epsilon : {1.0 / 3200, 0.125, 0.25, 0.375, 0.5 - 1.0 / 3200, 0.5}) {
    SCOPED_TRACE(epsilon);
    PointParameters at_energy = point();
    at_energy.Set(kEpsilon, epsilon);
    at_energy.Set(kExponent, 1);
    const PointSummary summary =
        RunPoint(SpecOf(&kFirstHit, at_energy, samples, model(), kSeedOfEngines));
    ExpectExactMeans(summary, 3);
    const KlDivergence& kl = *summary.kl_divergence;
    EXPECT_NEAR(kl.value, kl.noise_floor, 4 * kl.noise_error);
  }
}

INSTANTIATE_TEST_SUITE_P(
    FromCuspsToVanishingCells, EngineAtGeometry,
    testing::Combine(testing::Values(Model::kBilliard, Model::kBilliardReference),
                     testing::Values(RadiusAndShare{0.500001, 1}, RadiusAndShare{0.501, 1},
                                     RadiusAndShare{0.501, 0.2}, RadiusAndShare{0.51, 0.5},
                                     RadiusAndShare{kPaperRho, 1}, RadiusAndShare{kPaperRho, 0.2},
                                     RadiusAndShare{0.56, 0.7}, RadiusAndShare{0.6, 0.4},
                                     RadiusAndShare{0.65, 0.8}, RadiusAndShare{0.7, 0.5},
                                     RadiusAndShare{0.705, 0.9})));

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

// In gaps between discs that are a few roundings wide one ball in some 1e5 is trapped in a tip, and
// its path no longer grows. Single precision is refused there, but the engine ends all the same.
TEST(ConditionalMeanFreeTime, ABallThatRoundingTrapsInATipIsLost) {
  const PointParameters point = {{kRho, 0.5000001}, {kDelta, 0.05}, {kEpsilon, 0.1}};
  EnsembleSpec spec =
      SpecOf(&kConditionalMeanFreeTime, point, {.samples = 500'000}, Model::kBilliard, 3);
  spec.precision = Precision::kSingle;
  const PointSummary summary = RunPoint(spec);
  EXPECT_GE(summary.health.escapes, 1u);
  EXPECT_LE(summary.health.escapes, 20u);
}

// ---- a table that an independent program computed ----

constexpr size_t kRows = 20;

// 0 for equal values without scatter.
double CombinedZ(double a, double a_error, double b, double b_error) {
  const double error = std::hypot(a_error, b_error);
  return error == 0 ? (a == b ? 0 : INFINITY) : (a - b) / error;
}

class FirstHitTable : public testing::TestWithParam<size_t> {};

// Four means and a divergence within 4 combined standard errors: 6e-5 false alarms each, 0.6
// percent over the 100 comparisons of the table.
TEST_P(FirstHitTable, AgreesWithAnIndependentProgram) {
  const std::vector<oracle::ReferenceRow> table = oracle::ReferenceTable("first_hit.csv");
  ASSERT_EQ(table.size(), kRows);
  const auto reference = [&](const char* column) {
    return oracle::Number(table[GetParam()], column);
  };
  const PointParameters point = {{kRho, reference("rho")},
                                 {kDelta, reference("delta")},
                                 {kEpsilon, reference("epsilon")},
                                 {kExponent, reference("exponent")}};
  const PointSummary summary =
      RunPoint(SpecOf(&kFirstHit, point, {.samples = 400'000}, Model::kBilliard, 20));
  const double samples = reference("samples"), sigma = reference("mean_sigma");
  const auto expect_near = [&](size_t estimate, double value, double error) {
    const Estimate& measured = summary.estimates[estimate];
    EXPECT_LT(std::fabs(CombinedZ(measured.value, *measured.standard_error, value, error)), 4)
        << measured.name;
  };
  expect_near(0, reference("mean_time"), reference("mean_time_se"));
  expect_near(1, reference("mean_cos_alpha"), reference("mean_cos_alpha_se"));
  expect_near(2, sigma, std::sqrt((1 - sigma * sigma) / samples));
  // The table's coefficients of variation have four digits and no error; both runs have the same
  // number of samples, so the same error. Likewise the divergences.
  expect_near(3, reference("coefficient_of_variation"),
              std::hypot(*summary.estimates[3].standard_error, 5e-5));
  expect_near(4, reference("kl_1000_bins"), *summary.estimates[4].standard_error);
  EXPECT_EQ(summary.estimates[4].name, "kl_divergence");
  // The table's is that of the chi-squared law; the thinnest cells have some counts only.
  EXPECT_NEAR(*summary.estimates[4].noise_floor / reference("kl_noise"), 1, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Rows, FirstHitTable, testing::Range<size_t>(0, kRows));

// ---- the laws of first hits by lanes and reference ----

// Each has an independent sample at corners of the domain, at which a thousand returns are cheap.
struct Corner {
  PairGeometry geometry;
  double epsilon;
  int64_t samples;
};

void PrintTo(const Corner& corner, std::ostream* out) {
  *out << "rho " << corner.geometry.rho() << ", delta " << corner.geometry.delta() << ", epsilon "
       << corner.epsilon;
}

std::vector<Corner> Corners() {
  std::vector<Corner> corners;
  for (const double rho : {0.5 + 1e-9, 0.501, kPaperRho, 0.7, kMaxRho - 1e-9}) {
    for (const double share : {1.0, 0.1}) {  // delta over its bound
      for (const double epsilon : {0.0, 1e-6, 0.375, 0.5 - 1e-6, 0.5}) {
        const PairGeometry geometry = GeometryAtShare(rho, share);
        const double affordable = 1e7 / HitsPerReturn(geometry, epsilon).Events();
        if (affordable < 1000) continue;
        const double samples = std::min(affordable, 400'000.0) / (IsNightly() ? 1 : 2);
        corners.push_back({geometry, epsilon, static_cast<int64_t>(std::max(samples, 1000.0))});
      }
    }
  }
  return corners;
}

// The seed is the model's, so that the two samples are independent.
BlockResult FirstHits(Model model, const Corner& corner) {
  const PointParameters point = {{kRho, corner.geometry.rho()},
                                 {kDelta, corner.geometry.delta()},
                                 {kEpsilon, corner.epsilon},
                                 {kExponent, 1}};
  const EnsembleSpec spec =
      SpecOf(&kFirstHit, point, {.samples = corner.samples}, model, static_cast<uint64_t>(model));
  return FoldPoint(*PointExperiment::Create(spec, 0));
}

// The cells of the angle for both signs of the piston's velocity.
std::vector<uint64_t> IngoingCounts(const BlockResult& hits) {
  std::vector<uint64_t> counts;
  for (size_t i = 0; i + 1 < hits.histograms.size(); ++i) {
    const std::vector<uint64_t>& more = hits.histograms[i].counts;
    counts.insert(counts.end(), more.begin(), more.end());
  }
  return counts;
}

class TwoEngines : public testing::TestWithParam<Corner> {};

// The means of the time, of cos(alpha) and of sigma agree within 4 combined standard errors, with
// 6e-5 false alarms each. The laws of the angle and of the time are compared by chi^2, 3e-5 each.
// Over the 42 corners this makes 1.05 percent of false alarms.
TEST_P(TwoEngines, AgreeInMeansAndLaws) {
  const BlockResult reference = FirstHits(Model::kBilliardReference, GetParam());
  const BlockResult lanes = FirstHits(Model::kBilliard, GetParam());
  EXPECT_EQ(reference.health.escapes + lanes.health.escapes, 0u);
  for (size_t i = 0; i < lanes.moments.size(); ++i) {
    const Moments &a = reference.moments[i], &b = lanes.moments[i];
    const double z = CombinedZ(a.mean, *a.StandardError(), b.mean, *b.StandardError());
    EXPECT_LT(std::fabs(z), 4) << "mean " << i;
  }
  EXPECT_LT(oracle::ChiSquareScore(IngoingCounts(reference), IngoingCounts(lanes)), 4);
  EXPECT_LT(
      oracle::ChiSquareScore(reference.histograms.back().counts, lanes.histograms.back().counts),
      4);
}

INSTANTIATE_TEST_SUITE_P(Corners, TwoEngines, testing::ValuesIn(Corners()));

// Lifetimes of mean 1 and 1.05. Two samples of equal laws pass.
TEST(TwoSamples, DifferentLawsAreDetectedAndEqualLawsAreNot) {
  std::vector<uint64_t> counts[3];
  for (const size_t i : {0u, 1u, 2u}) {
    CounterRandom random(11, i, 0);
    counts[i].resize(200);  // the last ones hold few, if any
    for (int k = 0; k < 100'000; ++k) {
      const double x = -(i == 2 ? 1.05 : 1) * std::log(random.Uniform());
      ++counts[i][static_cast<size_t>(std::min(x * 20, 199.0))];
    }
  }
  EXPECT_LT(oracle::ChiSquareScore(counts[0], counts[1]), 4);
  EXPECT_GT(oracle::ChiSquareScore(counts[0], counts[2]), 4);
}

}  // namespace
}  // namespace ballpiston
