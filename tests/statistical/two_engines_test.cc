// Compares the laws of the billiard in lanes and of the reference. Each has an independent sample
// of first hits: 100,000 (nightly 400,000) at twenty points from cusps to vanishing cells, over
// energies and outgoing laws, and fewer at corners of the domain.
#include "core/arithmetic/elementary_functions.h"
#include "core/closed_form/ingoing_law.h"
#include "core/experiment/expected_returns.h"
#include "core/experiment/returns.h"
#include "core/statistics/histogram.h"
#include "tests/core/preamble.h"
#include "tests/core/run_orbits.h"
#include "tests/oracle/two_sample.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

constexpr uint64_t kSamplesOfARun = 50'000;  // as many as a block may have, about
constexpr size_t kBins = 1000;

struct Point {
  double rho;
  double share;  // delta over its bound; large, so that a return takes ten to a hundred events
  double epsilon;
  double exponent;
  double events = HUGE_VAL;  // that each engine may take, about
};

class FirstHits {
 public:
  explicit FirstHits(double epsilon) {
    const IngoingLaw law(epsilon);
    for (const int sigma : {-1, 1}) {
      const double width = law.AlphaMax(sigma);
      histograms_.push_back(Histogram::OfBins(-width, width, width > 0 ? kBins : 1));
    }
  }

  void Add(const Return& hit) {
    means_[0].Add(hit.time);
    means_[1].Add(hit.direction.x());
    means_[2].Add(hit.sigma);
    times_.push_back(hit.time);
    Histogram& histogram = histograms_[hit.sigma > 0 ? 1 : 0];
    if (histogram.upper > 0) {
      histogram.Add(Atan2(hit.direction.y(), hit.direction.x()));
    } else {
      ++histogram.counts[0];
    }
  }

  void CountEscape() { ++escapes_; }
  uint64_t escapes() const { return escapes_; }
  const std::array<Moments, 3>& means() const { return means_; }  // of time, cos alpha, sigma
  const std::vector<double>& times() const { return times_; }
  // Over the cells of alpha and sigma.
  std::vector<uint64_t> Counts() const {
    std::vector<uint64_t> counts = histograms_[0].counts;
    counts.insert(counts.end(), histograms_[1].counts.begin(), histograms_[1].counts.end());
    return counts;
  }

 private:
  uint64_t escapes_ = 0;
  std::array<Moments, 3> means_;
  std::vector<double> times_;
  std::vector<Histogram> histograms_;
};

uint64_t MostSamples() { return IsNightly() ? 400'000 : 100'000; }

uint64_t SamplesAt(const Point& point, const PairGeometry& geometry) {
  const double affordable = point.events / HitsPerReturn(geometry, point.epsilon).Events();
  return static_cast<uint64_t>(std::clamp(affordable, 1000.0, static_cast<double>(MostSamples())));
}

// The seed is the engine's, so that the two samples are independent.
FirstHits Sample(Engine engine, const Point& point) {
  const PairGeometry geometry = GeometryAtShare(point.rho, point.share);
  FirstHits hits(point.epsilon);
  const uint64_t samples = SamplesAt(point, geometry);
  const ReturnStarts starts = {geometry,
                               point.epsilon,
                               point.exponent,
                               {.seed = static_cast<uint64_t>(engine), .stream = 77}};
  const BlockResult empty;
  for (uint64_t first = 0; first < samples; first += kSamplesOfARun) {
    const uint64_t count = std::min(kSamplesOfARun, samples - first);
    BlockOrbits<ReturnOrbit, ReturnStarts> orbits(starts, {.first = first, .samples = count},
                                                  empty);
    EXPECT_TRUE(RunAll(engine, geometry, orbits));
    for (uint64_t i = 0; i < count; ++i) {
      const std::optional<Return>& hit = orbits[i].hit;
      hit ? hits.Add(*hit) : hits.CountEscape();
    }
  }
  return hits;
}

double Score(const Moments& first, const Moments& second) {
  const double error = std::hypot(*first.StandardError(), *second.StandardError());
  return error == 0 ? (first.mean == second.mean ? 0 : INFINITY)
                    : (second.mean - first.mean) / error;
}

class TwoEngines : public testing::TestWithParam<Point> {};

// Means agree within 4 combined standard errors, with 6e-5 false alarms each. The ingoing law is
// compared by chi^2 (3e-5), the law of the return times by Kolmogorov and Smirnov (5e-5). Over the
// 60 points this makes 1.5 percent of false alarms. The test detects a difference of 1 % between
// the distribution functions of the times, and one of 1.8 % of the standard deviation between
// means; at the nightly size half of these.
TEST_P(TwoEngines, AgreeInMeansAndLaws) {
  const FirstHits reference = Sample(Engine::kReference, GetParam());
  const FirstHits lanes = Sample(Engine::kLanes, GetParam());
  double scores[3];
  for (size_t i = 0; i < 3; ++i) scores[i] = Score(reference.means()[i], lanes.means()[i]);
  const double square = oracle::ChiSquareScore(reference.Counts(), lanes.Counts());
  const double distance = oracle::KolmogorovSmirnov(reference.times(), lanes.times());
  EXPECT_EQ(reference.escapes() + lanes.escapes(), 0u);
  for (const double score : scores) EXPECT_LT(std::fabs(score), 4);
  EXPECT_LT(square, 4);
  EXPECT_LT(distance, 2.3);
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
