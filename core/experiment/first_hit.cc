// Two experiments by returns to the collision surface at a fixed energy. The mean return time is
// their first estimate.
//
// conditional-mean-free-time starts from the invariant law (the paper's eq. taubpmftep). The closed
// form is exact at every delta, so this is a test of the billiard, not of the limit.
//
// first-hit is the paper's numerical test of the Markov property: orbits start uniformly on the
// collision surface with an outgoing law h^(n); the ingoing (alpha, sigma) of the first ball-piston
// collision is recorded. Histograms of alpha have 1000 bins over the interval permitted for each
// sign of the piston's velocity. Their relative entropy with respect to h^(1) is the paper's eq.
// kld. The last histogram is that of return times. For n = 1 the process is stationary at every
// delta, and the result has the exact values.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/closed_form/ingoing_law.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/expected_returns.h"
#include "core/experiment/pair_experiment.h"
#include "core/experiment/returns.h"
#include "core/statistics/stated_error.h"

namespace ballpiston {
namespace {

constexpr double kInvariantExponent = 1;
constexpr double kExactMeanRelativeError =
    kMeanFreeTimeRelativeError + kConditionalRateRelativeError;

constexpr char kConditionalTime[] = "mean_free_time_conditional";
constexpr char kHitTime[] = "mean_hit_time";

enum Mean : size_t { kTime, kCosAlpha, kSigma, kMeans };

// ---- what their rows share ----

// Outgoing directions are drawn by rejection, which takes more draws for larger exponents.
double StartsOf(const PointParameters& point) {
  constexpr double kByRootOfExponent = 0.3;
  return 1 + kByRootOfExponent * std::sqrt(point.Find(kExponent).value_or(0));
}

Forecast ForecastOfAReturn(Model, const PointParameters& point) {
  // At epsilon = 0 there are no long returns, but some returns are long.
  constexpr double kLeastShareOfLongReturns = 0.01;
  const PredictedHits hits = HitsPerReturn(GeometryOf(point), point[kEpsilon]);
  const double long_returns = LongReturnsPerSample(GeometryOf(point), point[kEpsilon]);
  return {.work = {.ball_wall = hits.ball_wall,
                   .piston_wall = hits.piston_wall,
                   .starts = StartsOf(point),
                   .parts = std::clamp(long_returns, kLeastShareOfLongReturns, 1.0)},
          .memory = kMemoryOfPairs};
}

// The ball rests at a distance d from the left end of the piston's way, with a density that falls
// about linearly from d = 0 to delta, so that d has the mean delta/3 and the standard deviation
// delta sqrt(2)/6. The piston comes back after the path 2 (stroke - d).
double ErrorAtRest(const PairGeometry& geometry) {
  const double delta = geometry.delta();
  return delta * std::numbers::sqrt2 / 6 / (geometry.stroke() - delta / 3);
}

// The scatter of the return time. Rare long returns dominate the mean, so the scatter of their
// number is the error of the mean. Where long returns are rare, they are the events that determine
// the error.
Scatter ScatterOfAReturn(Model, const PointParameters& point) {
  const PairGeometry geometry = GeometryOf(point);
  if (point[kEpsilon] == 0.5) return {ErrorAtRest(geometry)};
  const double long_returns = LongReturnsPerSample(geometry, point[kEpsilon]);
  return {std::sqrt(0.9 * (1 + 1 / long_returns)), std::min(long_returns, 1.0)};
}

// ---- both experiments ----

class ReturnExperiment : public PairExperiment {
 public:
  ReturnExperiment(const EnsembleSpec& spec, const PointParameters& point, double exponent)
      : PairExperiment(spec, point),
        exponent_(exponent),
        exact_mean_(ConditionalMeanFreeTime(geometry(), point[kEpsilon])) {
    if (!TakesSamples(answer().model)) return;
    starts_ = ReturnStarts{.geometry = geometry(),
                           .epsilon = point[kEpsilon],
                           .exponent = exponent,
                           .random = random()};
    events_ = ScatterOf(spec, point).events;
  }

 protected:
  const ReturnStarts& starts() const { return *starts_; }  // only of a model that takes samples
  // Under the invariant law, at every delta.
  double exact_mean() const { return exact_mean_; }
  double events() const { return events_; }
  std::optional<double> IfStationary(double exact) const {
    return exponent_ == kInvariantExponent ? std::optional(exact) : std::nullopt;
  }

  Measurement MeanTime(std::string name) const {
    return {.name = std::move(name),
            .reading = MeanAt(kTime, events_),
            .exact = IfStationary(exact_mean_),
            .known = {{exact_mean_, kExactMeanRelativeError * exact_mean_}}};
  }

  Measurement CoefficientOfVariation() const {
    return {"coefficient_of_variation",
            [this](const BlockResult& merged) { return Variation(merged.moments[kTime]); }};
  }

 private:
  double EventsIn(const Moments& times) const { return static_cast<double>(times.count) * events_; }

  // Empty if the mean has no error; the scatter of the sample has no meaning then. One return in
  // twenty counts as an event for the error of the coefficient itself: it depends on the squares of
  // the times, whose law is much more skewed. For an exponential law 64, 256 and 1000 samples gave
  // intervals of 95 % that covered in 85, 91 and 93 %, with Student's t for the batches
  // of the mean. So its batches are a twentieth of these as well.
  std::optional<Estimate> Variation(const Moments& times) const {
    constexpr double kEventsOfScatter = 0.05;
    const std::optional<double> value = times.CoefficientOfVariation();
    if (!HasStatedError(EventsIn(times)) || !value) return std::nullopt;
    const auto batches = static_cast<double>(times.EffectiveCount());
    return Estimate{.value = *value,
                    .standard_error = StatedError(kEventsOfScatter * EventsIn(times), *value,
                                                  times.CoefficientOfVariationError()),
                    .batches = static_cast<uint64_t>(std::fmax(2, kEventsOfScatter * batches))};
  }

  double exponent_;
  double exact_mean_;
  std::optional<ReturnStarts> starts_;  // takes some 4 us to make, 20 us if exponent is no integer
  double events_ = 0;                   // of a sample, for the error of the mean
};

// ---- conditional-mean-free-time ----

class ConditionalMeanFreeTimeExperiment : public ReturnExperiment {
 public:
  ConditionalMeanFreeTimeExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : ReturnExperiment(spec, point, kInvariantExponent) {
    SetMeasurements({.moments = std::vector<Moments>(1)},
                    {MeanTime(kConditionalTime), CoefficientOfVariation()});
  }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override {
    return RunOrbits<ReturnOrbit>(queue, starts());
  }
};

constexpr ParameterUse kParametersOfConditional[] = {{&kRho}, {&kDelta}, {&kEpsilon}};
constexpr Model kModelsOfConditional[] = {Model::kClosedForm, Model::kBilliard,
                                          Model::kBilliardReference};
constexpr absl::string_view kNoVariance =
    "the return time has no variance at epsilon = 0; permitted: epsilon > 0, or samples or "
    "collisions";

constexpr AimedEstimate kAimsOfConditional[] = {{.name = kConditionalTime,
                                                 .models = kModelsOfConditional,
                                                 .scatter = ScatterOfAReturn,
                                                 .numerical_error = ErrorOfClosedForms,
                                                 .no_error = kNoVariance}};

// ---- first-hit ----

// All histograms but the last.
template <typename Histograms>
auto IngoingOf(Histograms& histograms) {
  return std::span(histograms).first(histograms.size() - 1);
}

struct FirstHitOrbit : ReturnOrbit {
  void AddTo(const ReturnStarts& starts, BlockResult& result) const {
    if (!hit) return;
    ReturnOrbit::AddTo(starts, result);
    result.moments[kCosAlpha].Add(hit->direction.x());
    result.moments[kSigma].Add(hit->sigma);
    CountIngoing(*hit, IngoingOf(result.histograms));
    result.histograms.back().Add(hit->time);
  }
};

class FirstHitExperiment : public ReturnExperiment {
 public:
  FirstHitExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : ReturnExperiment(spec, point, point[kExponent]), equilibrium_(point[kEpsilon]) {
    BlockResult empty = {.moments = std::vector<Moments>(kMeans),
                         .histograms = EmptyIngoingHistograms(equilibrium_)};
    empty.histograms.push_back(EmptyReturnTimes(exact_mean()));
    SetMeasurements(std::move(empty), {MeanTime(kHitTime),
                                       {.name = "mean_cos_alpha",
                                        .reading = MeanAt(kCosAlpha, EventsOfCosAlpha()),
                                        .exact = IfStationary(equilibrium_.MeanCosAlpha())},
                                       {.name = "mean_sigma",
                                        .reading = MeanSigma(),
                                        .exact = IfStationary(equilibrium_.MeanSigma())},
                                       CoefficientOfVariation()});
  }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override {
    return RunOrbits<FirstHitOrbit>(queue, starts());
  }

 protected:
  void AddDetails(const BlockResult& merged, PointSummary& summary) const override {
    for (const Histogram& histogram : IngoingOf(merged.histograms)) {
      const int sigma = kIngoingSigmas[summary.histograms.size()];
      summary.histograms.push_back({"alpha", sigma, histogram});
    }
    summary.curves = {Survival(merged.histograms.back())};
    if (merged.samples > 0) AddDistanceFromEquilibrium(merged, summary);
  }

 private:
  // If the ball or the piston has all the energy, the other rests until they meet, so the law is
  // not exponential.
  Curve Survival(const Histogram& times) const {
    const double epsilon = starts().epsilon;
    const bool has_long_returns = epsilon > 0;
    Curve survival = SurvivalCurve(times, exact_mean(), has_long_returns ? events() : 1);
    if (epsilon > 0 && epsilon < 0.5) return survival;
    for (CurvePoint& point : survival.points) point.limit.reset();
    return survival;
  }

  bool PistonIsSlower() const { return equilibrium_.AlphaMax(+1) > 0; }

  // From a large exponent the ball starts along the axis, and while a slow piston hardly moves,
  // most returns are along the axis too. The few others determine the mean. Of intervals at
  // rho = 0.7, exponent 1000 and epsilon <= 1e-4, 73 % covered with 64 samples and 95 % with 800;
  // with exponent 100, 95 % covered with 64.
  double EventsOfCosAlpha() const {
    constexpr double kOverExponent = 60;
    return PistonIsSlower() ? std::min(1.0, kOverExponent / starts().exponent + events()) : 1;
  }

  // The mean of sigma = +1 or -1, which is a count of the rarer sign. The interval from a small
  // count covers in 93 to 97 %, depending on the place of the true mean between the possible ones;
  // from 50 on in 94.1 to 95.8 %. The expected count is that of the equilibrium's law, or that of
  // starts with -1 and long returns if this is less: in a short return a slow piston keeps its
  // sign. If only -1 is possible, the mean has no error.
  Reading MeanSigma() const {
    if (PistonIsSlower()) {
      const double of_equilibrium = (1 - std::fabs(equilibrium_.MeanSigma())) / 2;
      return MeanAt(kSigma, std::min(of_equilibrium, StartsToTheLeft() + events()));
    }
    return [](const BlockResult& merged) {
      return Estimate{.value = MeanOf(merged.moments[kSigma], 0).value, .standard_error = 0};
    };
  }

  // The share of starts with sigma = -1, from the largest densities of both signs.
  double StartsToTheLeft() const {
    const auto [ball, piston] = std::pair(starts().ball_speed, starts().piston_speed);
    const double odds = std::pow((ball - piston) / (ball + piston), starts().exponent);
    return odds / (1 + odds);
  }

  void AddDistanceFromEquilibrium(const BlockResult& merged, PointSummary& summary) const {
    const KlDivergence distance = DistanceFromEquilibrium(merged);
    summary.kl_divergence = distance;
    summary.estimates.push_back({.name = "kl_divergence",
                                 .value = distance.value,
                                 .standard_error = distance.standard_error,
                                 .noise_floor = distance.noise_floor});
  }

  KlDivergence DistanceFromEquilibrium(const BlockResult& merged) const {
    std::vector<uint64_t> counts;
    for (const Histogram& histogram : IngoingOf(merged.histograms)) {
      counts.insert(counts.end(), histogram.counts.begin(), histogram.counts.end());
    }
    std::vector<double> expected;
    for (const std::vector<double>& bins : IngoingBinProbabilities(equilibrium_)) {
      expected.insert(expected.end(), bins.begin(), bins.end());
    }
    return RelativeEntropy(counts, expected);
  }

  IngoingLaw equilibrium_;
};

std::vector<std::vector<double>> ExpectedProbabilities(const PointParameters& point) {
  return IngoingBinProbabilities(IngoingLaw(point[kEpsilon]));
}

constexpr ParameterUse kParametersOfFirstHit[] = {{&kRho}, {&kDelta}, {&kEpsilon}, {&kExponent}};
constexpr AimedEstimate kAimsOfFirstHit[] = {
    {.name = kHitTime, .models = kBilliards, .scatter = ScatterOfAReturn, .no_error = kNoVariance}};

// The noise of the relative entropy is a sum over the counts of 1,000 or 2,000 cells. Measured: 2
// to 4 ms, where a jump takes 50 ns.
constexpr double kWorkOfNoise = 5e4;  // jumps

}  // namespace

constinit const ExperimentKind kConditionalMeanFreeTime = {
    .name = "conditional-mean-free-time",
    .number = 2,
    .parameters = kParametersOfConditional,
    .aims = kAimsOfConditional,
    .create = CreateAs<ConditionalMeanFreeTimeExperiment>,
    .check_grid = CheckPairGrid,
    .forecast = ForecastOfAReturn};

// No closed form answers this experiment, not even at exponent 1, because it measures a law.
constinit const ExperimentKind kFirstHit = {.name = "first-hit",
                                            .number = 3,
                                            .parameters = kParametersOfFirstHit,
                                            .aims = kAimsOfFirstHit,
                                            .create = CreateAs<FirstHitExperiment>,
                                            .check_grid = CheckPairGrid,
                                            .forecast = ForecastOfAReturn,
                                            .summary = kWorkOfNoise,
                                            .expected_probabilities = ExpectedProbabilities};

}  // namespace ballpiston
