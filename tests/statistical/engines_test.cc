// Compares both engines with all closed forms that exist, the lanes with first hits of an
// independent program, and the engines with each other.
#include "core/billiard/billiard_domain.h"
#include "core/experiment/expected_returns.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
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

// Three means in equilibrium and one at each of six energies: 180 comparisons in all, one false
// alarm in 800 choices of the seed. The test detects errors of 2 % (lanes) or 5 % (reference),
// and at the nightly size of 1 % or 3 %.
TEST_P(EngineAtGeometry, MeansMatchTheClosedForms) {
  const Target collisions = {.collisions = SamplesBy(model(), 200'000)};
  ExpectExactMeans(RunPoint(SpecOf(&kEquilibrium, point(), collisions, model(), kSeedOfEngines)),
                   3);
  // With fewer samples than the reference's 2000 there are too few long returns for an error.
  const Target samples = {.samples = std::max<int64_t>(SamplesBy(model(), 20'000), 2000)};
  // At epsilon = 1/2 the ball rests, and the mean is over the part of the volume that is visited.
  for (const double epsilon : {1.0 / 3200, 0.125, 0.25, 0.375, 0.5 - 1.0 / 3200, 0.5}) {
    SCOPED_TRACE(epsilon);
    PointParameters at_energy = point();
    at_energy.Set(kEpsilon, epsilon);
    ExpectExactMeans(
        RunPoint(SpecOf(&kConditionalMeanFreeTime, at_energy, samples, model(), kSeedOfEngines)),
        1);
  }
}

INSTANTIATE_TEST_SUITE_P(
    FromCuspsToVanishingCells, EngineAtGeometry,
    testing::Combine(testing::Values(Model::kBilliard, Model::kBilliardReference),
                     testing::Values(RadiusAndShare{0.501, 1}, RadiusAndShare{0.501, 0.2},
                                     RadiusAndShare{0.51, 0.5}, RadiusAndShare{kPaperRho, 1},
                                     RadiusAndShare{kPaperRho, 0.2}, RadiusAndShare{0.56, 0.7},
                                     RadiusAndShare{0.6, 0.4}, RadiusAndShare{0.65, 0.8},
                                     RadiusAndShare{0.7, 0.5}, RadiusAndShare{0.705, 0.9})));

class Engines : public testing::TestWithParam<Model> {};

// The invariant law is its own ingoing law at every delta: the divergence is noise, within 4 errors
// of its floor (6e-5), and the means are the closed forms: 30 divergences and 90 means, one false
// alarm in 400 choices of the seed.
TEST_P(Engines, FirstHitsOfTheInvariantLawAreAtTheNoiseFloor) {
  const int64_t samples = SamplesBy(GetParam(), 200'000);
  for (const double delta : {0.325, 0.1, 0.05}) {
    for (const double epsilon : {0.03125, 0.125, 0.25, 0.375, 0.46875}) {
      SCOPED_TRACE(testing::Message() << "delta " << delta << ", epsilon " << epsilon);
      const PointSummary summary =
          RunPoint(SpecOf(&kFirstHit, PaperPoint(delta, epsilon, 1), {.samples = samples},
                          GetParam(), kSeedOfEngines));
      ExpectExactMeans(summary, 3);
      const KlDivergence& kl = *summary.kl_divergence;
      EXPECT_NEAR(kl.value, kl.noise_floor, 4 * kl.noise_error);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Engines,
                         testing::Values(Model::kBilliard, Model::kBilliardReference));

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

// A row of tests/data/first_hit.csv, by the names of the columns.
std::map<std::string, double> ReferenceRow(size_t row) {
  const std::vector<std::string> lines =
      absl::StrSplit(Contents(SourcePath("tests/data/first_hit.csv")), '\n', absl::SkipEmpty());
  EXPECT_EQ(lines.size(), 1 + kRows);
  const std::vector<std::string> names = absl::StrSplit(lines.at(0), ','),
                                 cells = absl::StrSplit(lines.at(1 + row), ',');
  std::map<std::string, double> values;
  for (size_t i = 0; i < names.size(); ++i)
    values[names[i]] = std::strtod(cells.at(i).c_str(), nullptr);
  return values;
}

// 0 for equal values without scatter.
double CombinedZ(double a, double a_error, double b, double b_error) {
  const double error = std::hypot(a_error, b_error);
  return error == 0 ? (a == b ? 0 : INFINITY) : (a - b) / error;
}

class FirstHitTable : public testing::TestWithParam<size_t> {};

// Four means and a divergence within 4 combined standard errors: 6e-5 false alarms each, 0.6
// percent over the 100 comparisons of the table.
TEST_P(FirstHitTable, AgreesWithAnIndependentProgram) {
  const std::map<std::string, double> row = ReferenceRow(GetParam());
  const auto reference = [&row](const char* column) { return row.at(column); };
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

// Each has an independent sample of 100,000 (nightly 400,000) at twenty points from cusps to
// vanishing cells, over energies and outgoing laws, and of fewer at corners of the domain.
struct Point {
  double rho;
  double share;  // delta over its bound; large, so that a return takes ten to a hundred events
  double epsilon;
  double exponent;
  double events = HUGE_VAL;  // that each engine may take, about
};

int64_t SamplesAt(const Point& point, const PairGeometry& geometry) {
  const double most = IsNightly() ? 400'000 : 100'000;
  const double affordable = point.events / HitsPerReturn(geometry, point.epsilon).Events();
  return static_cast<int64_t>(std::clamp(affordable, 1000.0, most));
}

// The seed is the model's, so that the two samples are independent.
BlockResult FirstHits(Model model, const Point& point) {
  const PairGeometry geometry = GeometryAtShare(point.rho, point.share);
  const PointParameters parameters = {{kRho, geometry.rho()},
                                      {kDelta, geometry.delta()},
                                      {kEpsilon, point.epsilon},
                                      {kExponent, point.exponent}};
  const EnsembleSpec spec = SpecOf(&kFirstHit, parameters, {.samples = SamplesAt(point, geometry)},
                                   model, static_cast<uint64_t>(model));
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

class TwoEngines : public testing::TestWithParam<Point> {};

// The means of the time, of cos(alpha) and of sigma agree within 4 combined standard errors, with
// 6e-5 false alarms each. The laws of the angle and of the time are compared by chi^2, 3e-5 each.
// Over the 60 points this makes 1.4 percent of false alarms. The test detects a difference of 1.8 %
// of the standard deviation between means; at the nightly size half of it.
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

INSTANTIATE_TEST_SUITE_P(
    FromCuspsToVanishingCells, TwoEngines,
    testing::Values(Point{0.500001, 1, 0.25, 1}, Point{0.501, 1, 0.125, 1},
                    Point{0.501, 0.7, 0.375, 10}, Point{0.505, 0.7, 0.46875, 1},
                    Point{0.505, 1, 0.03125, 5}, Point{0.51, 1, 0.125, 10},
                    Point{0.51, 0.5, 0.46875, 1}, Point{kPaperRho, 1, 0.125, 1},
                    Point{kPaperRho, 1, 0.03125, 0}, Point{kPaperRho, 0.7, 0.25, 10},
                    Point{kPaperRho, 0.5, 0.375, 0.5}, Point{kPaperRho, 0.3, 0.46875, 5},
                    Point{0.56, 1, 0.03125, 1}, Point{0.56, 0.7, 0.375, 0}, Point{0.6, 1, 0.125, 5},
                    Point{0.6, 0.7, 0.46875, 2.5}, Point{0.65, 1, 0.25, 1},
                    Point{0.69, 1, 0.375, 5}, Point{0.7, 1, 0.46875, 1},
                    Point{0.705, 1, 0.499, 10}));

// The corners at which a thousand samples take no longer than the points above.
std::vector<Point> Corners() {
  constexpr double kEvents = 1e7;
  std::vector<Point> corners;
  for (const double rho : {0.5 + 1e-9, 0.501, kPaperRho, 0.7, kMaxRho - 1e-9}) {
    for (const double share : {1.0, 0.1}) {
      for (const double epsilon : {0.0, 1e-6, 0.5 - 1e-6, 0.5}) {
        const double events = HitsPerReturn(GeometryAtShare(rho, share), epsilon).Events();
        if (1000 * events <= kEvents)
          corners.push_back({rho, share, epsilon, 1, IsNightly() ? kEvents : kEvents / 2});
      }
    }
  }
  return corners;
}

INSTANTIATE_TEST_SUITE_P(Corners, TwoEngines, testing::ValuesIn(Corners()));

// Lifetimes of mean 1 + shift.
std::vector<double> Lifetimes(uint64_t stream, size_t count, double shift) {
  CounterRandom random(11, stream, 0);
  std::vector<double> sample(count);
  for (double& x : sample) x = -(1 + shift) * std::log(random.Uniform());
  return sample;
}

std::vector<uint64_t> Histogrammed(const std::vector<double>& sample) {
  std::vector<uint64_t> counts(200);  // the last ones hold few, if any
  for (const double x : sample) ++counts[static_cast<size_t>(std::min(x * 20, 199.0))];
  return counts;
}

// A difference of 5 % is detected. Equal laws pass.
TEST(TwoSamples, DifferentLawsAreDetectedAndEqualLawsAreNot) {
  const std::vector<double> first = Lifetimes(0, 100'000, 0);
  for (const double shift : {0.0, 0.05}) {
    const std::vector<double> second = Lifetimes(1, 100'000, shift);
    const double square = oracle::ChiSquareScore(Histogrammed(first), Histogrammed(second));
    const double distance = oracle::KolmogorovSmirnov(first, second);
    EXPECT_EQ(square > 4, shift > 0) << square;
    EXPECT_EQ(distance > 2.3, shift > 0) << distance;
  }
}

}  // namespace
}  // namespace ballpiston
