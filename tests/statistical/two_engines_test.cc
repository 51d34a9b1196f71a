// Compares the laws of first hits by the lanes and by the reference. Each has an independent sample
// of 100,000 (nightly 400,000) at twenty points from cusps to vanishing cells, over energies and
// outgoing laws, and of fewer at corners of the domain.
#include "core/experiment/expected_returns.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/oracle/samples.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

struct Point {
  double rho;
  double share;  // delta over its bound; large, so that a return takes ten to a hundred events
  double epsilon;
  double exponent;
  double events = HUGE_VAL;  // that each engine may take, about
};

uint64_t MostSamples() { return IsNightly() ? 400'000 : 100'000; }

int64_t SamplesAt(const Point& point, const PairGeometry& geometry) {
  const double affordable = point.events / HitsPerReturn(geometry, point.epsilon).Events();
  return static_cast<int64_t>(std::clamp(affordable, 1000.0, static_cast<double>(MostSamples())));
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

double Score(const Moments& first, const Moments& second) {
  const double error = std::hypot(*first.StandardError(), *second.StandardError());
  return error == 0 ? (first.mean == second.mean ? 0 : INFINITY)
                    : (second.mean - first.mean) / error;
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
    EXPECT_LT(std::fabs(Score(reference.moments[i], lanes.moments[i])), 4) << "mean " << i;
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
