#include "core/method_comparison/method_comparison.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/arithmetic/number_text.h"
#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/ingoing_law.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/long_returns.h"
#include "core/geometry/pair_geometry.h"
#include "core/method_comparison/energy_relaxation_runs.h"
#include "core/method_comparison/ingoing_divergence.h"
#include "core/method_comparison/processor_time.h"
#include "core/method_comparison/returns.h"
#include "core/method_comparison/trajectory_horizon.h"
#include "core/method_comparison/twin_orbits.h"
#include "core/statistics/kl_divergence.h"
#include "core/statistics/told_error.h"

namespace ballpiston {
namespace {

constexpr double kTimeSteps[] = {1e-1, 1e-2, 1e-3, 1e-4};

constexpr uint64_t kRungFactor = 4;
constexpr uint64_t kFewestReturns = 16;
constexpr size_t kFewestOrbits = 64;

// A rung is run if this many times seconds_per_curve is enough for it: then the largest is between
// a half and twice of seconds_per_curve.
constexpr double kOverrun = 2;

// The truth about a relaxation time may take some so many times a curve's seconds.
constexpr double kTruthTimes = 8;

// For sampled methods: what wall hits the twins need for the longest of them, 113 bits.
constexpr size_t kTwinHits = 110;

std::vector<MethodVariant> SampledVariants() {
  std::vector<MethodVariant> variants;
  for (const double step : kTimeSteps) variants.push_back({Method::kFixedStep, step});
  for (const Method method :
       {Method::kReferenceSingle, Method::kReference, Method::kReferenceLongDouble,
        Method::kReferenceQuadruple, Method::kLanes, Method::kLanesSingle}) {
    variants.push_back({method});
  }
  return variants;
}

// The chi-squared law's, with the scatter that a divergence which is there adds.
double ErrorOfDivergence(const DivergenceNoise& noise, double excess, uint64_t samples) {
  const double bias = std::fmax(excess, 0);
  return std::hypot(noise.standard_deviation, std::sqrt(2 * bias / static_cast<double>(samples)));
}

class Comparison {
 public:
  Comparison(const MethodComparisonSpec& spec, const PairGeometry& geometry,
             std::vector<PairGeometry> relaxing, const std::stop_token& stop,
             const std::function<void(const MethodMeasurement&)>& tell)
      : spec_(spec),
        geometry_(geometry),
        relaxing_(std::move(relaxing)),
        stop_(stop),
        tell_(tell),
        exact_(ConditionalMeanFreeTime(geometry, spec.epsilon)),
        probabilities_(IngoingProbabilities(spec.epsilon)) {}

  // False if `stop` came before the end.
  bool Run() {
    if (!CompareReturns(Quantity::kMeanFreeTime) || !CompareReturns(Quantity::kIngoingLaw)) {
      return false;
    }
    return CompareTrajectories() && CompareRelaxationTimes();
  }

 private:
  double Limit() const { return kOverrun * spec_.seconds_per_curve; }

  RandomStream Stream(Quantity quantity, uint64_t rung) const {
    return {spec_.seed, (static_cast<uint64_t>(quantity) << 32) | rung};
  }

  bool CompareReturns(Quantity quantity) {
    for (const MethodVariant& variant : SampledVariants()) {
      if (!ClimbReturns(quantity, variant)) return false;
    }
    tell_(quantity == Quantity::kMeanFreeTime ? ClosedMeanFreeTime() : ClosedIngoingLaw());
    return true;
  }

  bool ClimbReturns(Quantity quantity, const MethodVariant& variant) {
    double expected = PredictedSeconds(variant, geometry_, spec_.epsilon, kFewestReturns);
    uint64_t samples = kFewestReturns;
    for (uint64_t rung = 0; expected <= Limit(); ++rung, samples *= kRungFactor) {
      const std::optional<ReturnStatistics> returns =
          RunReturns(variant, geometry_, spec_.epsilon, Stream(quantity, rung), samples, stop_);
      if (!returns) return false;
      if (returns->times.count > 0) tell_(Measured(quantity, variant, *returns));
      expected = returns->seconds * kRungFactor;
    }
    return true;
  }

  MethodMeasurement Measured(Quantity quantity, const MethodVariant& variant,
                             const ReturnStatistics& returns) {
    MethodMeasurement measurement = {.method = variant.method,
                                     .time_step = variant.time_step,
                                     .quantity = quantity,
                                     .delta = spec_.delta,
                                     .samples = returns.times.count,
                                     .wall_hits = returns.wall_hits,
                                     .work = returns.seconds};
    if (quantity == Quantity::kMeanFreeTime) {
      measurement.value = std::fabs(returns.times.mean - exact_) / exact_;
      measurement.statistical_error = ErrorOfMean(returns.times) / exact_;
    } else {
      const DivergenceNoise noise = NoiseOf(returns.times.count);
      measurement.value =
          RelativeEntropy(returns.ingoing.Counts(), probabilities_).value - noise.mean;
      measurement.statistical_error =
          ErrorOfDivergence(noise, measurement.value, returns.times.count);
    }
    return measurement;
  }

  DivergenceNoise NoiseOf(uint64_t samples) {
    const auto [noise, is_new] = noise_.try_emplace(samples);
    if (is_new) noise->second = NoiseOfDivergence(samples, probabilities_);
    return noise->second;
  }

  double ErrorOfMean(const Moments& times) {
    const double count = static_cast<double>(times.count);
    const double long_returns = count * LongReturnsPerSample(geometry_, spec_.epsilon);
    if (TellsItsError(long_returns)) return times.StandardError().value_or(0);
    return std::sqrt(VarianceOfTimes() / count);
  }

  // Of as many returns as can tell it, or as time permits.
  double VarianceOfTimes() {
    constexpr double kFewest = 256, kMost = 65536;
    if (variance_of_times_) return *variance_of_times_;
    const MethodVariant lanes = {Method::kLanes};
    const double affordable =
        spec_.seconds_per_curve / PredictedSeconds(lanes, geometry_, spec_.epsilon, 1);
    const double wanted = kEventsForAnError / LongReturnsPerSample(geometry_, spec_.epsilon);
    const double samples = std::clamp(wanted, kFewest, std::clamp(affordable, kFewest, kMost));
    const std::optional<ReturnStatistics> returns =
        RunReturns(lanes, geometry_, spec_.epsilon, {spec_.seed, ~uint64_t{0}},
                   static_cast<uint64_t>(samples), stop_);
    variance_of_times_ = returns ? returns->times.Variance().value_or(0) : 0;
    return *variance_of_times_;
  }

  MethodMeasurement ClosedMeanFreeTime() const {
    return {.method = Method::kClosedForm,
            .quantity = Quantity::kMeanFreeTime,
            .delta = spec_.delta,
            .work = SecondsOf([&] { ConditionalMeanFreeTime(geometry_, spec_.epsilon); }),
            .value = kMeanFreeTimeRelativeError + kConditionalRateRelativeError};
  }

  // The divergence of a law whose cells are off by e each, relatively, is at most e^2/2.
  MethodMeasurement ClosedIngoingLaw() const {
    return {.method = Method::kClosedForm,
            .quantity = Quantity::kIngoingLaw,
            .delta = spec_.delta,
            .work = SecondsOf([&] { IngoingProbabilities(spec_.epsilon); }),
            .value = kIngoingLawRelativeError * kIngoingLawRelativeError / 2};
  }

  // The twins are common to all methods, and dearer than any of them: they say how many orbits.
  bool CompareTrajectories() {
    std::vector<TwinOrbits> rungs;
    double expected = 0;
    for (size_t orbits = kFewestOrbits; expected <= Limit(); orbits *= kRungFactor) {
      const double begin = ThreadSeconds();
      rungs.emplace_back(geometry_, Stream(Quantity::kTrajectory, rungs.size()), orbits);
      if (!rungs.back().FlyAhead(kTwinHits, stop_)) return false;
      expected = (ThreadSeconds() - begin) * kRungFactor;
    }
    for (const MethodVariant& variant : SampledVariants()) {
      if (!ClimbTrajectories(variant, rungs)) return false;
    }
    return true;
  }

  bool ClimbTrajectories(const MethodVariant& variant, std::span<TwinOrbits> rungs) {
    double expected = 0;
    for (size_t rung = 0; rung < rungs.size() && expected <= Limit(); ++rung) {
      const TrajectoryHorizon horizon = HorizonOf(variant, geometry_, rungs[rung], stop_);
      if (stop_.stop_requested()) return false;
      tell_({.method = variant.method,
             .time_step = variant.time_step,
             .quantity = Quantity::kTrajectory,
             .delta = spec_.delta,
             .samples = horizon.hits.count,
             .wall_hits = horizon.wall_hits,
             .work = horizon.seconds,
             .value = horizon.hits.mean,
             .statistical_error = horizon.hits.StandardError().value_or(0)});
      expected = horizon.seconds * kRungFactor;
    }
    return true;
  }

  bool CompareRelaxationTimes() {
    for (const PairGeometry& geometry : relaxing_) {
      if (!CompareRelaxationTimesOf({geometry, spec_.seed})) return false;
    }
    return true;
  }

  bool CompareRelaxationTimesOf(const EnergyRelaxationRuns& runs) {
    const uint64_t orbits = OrbitsOfTruth(runs);
    if (orbits < kFewestTruthOrbits) return true;
    const RelaxationTime limit = runs.BySpectrum();  // first: no run has to make the spectrum
    const std::optional<RelaxationTime> truth = runs.Run(Method::kLanes, TruthOf(orbits), stop_);
    if (!truth || !ClimbRelaxationTimes(runs, Method::kLanes, *truth) ||
        !ClimbRelaxationTimes(runs, Method::kMarkov, *truth)) {
      return false;
    }
    tell_(Compared(runs.delta(), Method::kSpectrum, limit, *truth));
    return !stop_.stop_requested();
  }

  // The power of two whose logarithm is nearest. By the prediction, not by what was measured: the
  // truth follows from the spec.
  uint64_t OrbitsOfTruth(const EnergyRelaxationRuns& runs) const {
    const double orbits = kTruthTimes * spec_.seconds_per_curve / runs.PredictedSecondsPerOrbit();
    return std::bit_floor(static_cast<uint64_t>(std::numbers::sqrt2 * orbits));
  }

  bool ClimbRelaxationTimes(const EnergyRelaxationRuns& runs, Method method,
                            const RelaxationTime& truth) {
    double expected = 0;
    for (uint64_t orbits = kFewestOrbits; expected <= Limit(); orbits *= kRungFactor) {
      const std::optional<RelaxationTime> measured = runs.Run(method, RunOf(orbits), stop_);
      if (!measured) return false;
      tell_(Compared(runs.delta(), method, *measured, truth));
      expected = measured->seconds * kRungFactor;
    }
    return true;
  }

  static MethodMeasurement Compared(double delta, Method method, const RelaxationTime& measured,
                                    const RelaxationTime& truth) {
    const double ratio = measured.value / truth.value;
    return {.method = method,
            .quantity = Quantity::kRelaxationTime,
            .delta = delta,
            .samples = measured.samples,
            .work = measured.seconds,
            .value = std::fabs(ratio - 1),
            .statistical_error = std::hypot(measured.error, ratio * truth.error) / truth.value};
  }

  const MethodComparisonSpec spec_;
  const PairGeometry geometry_;
  const std::vector<PairGeometry> relaxing_;
  const std::stop_token& stop_;
  const std::function<void(const MethodMeasurement&)>& tell_;
  const double exact_;
  const std::vector<double> probabilities_;
  std::optional<double> variance_of_times_;
  std::map<uint64_t, DivergenceNoise> noise_;  // by samples: the same for all methods
};

absl::StatusOr<std::vector<PairGeometry>> RelaxingGeometries(const MethodComparisonSpec& spec) {
  if (spec.relaxation_deltas.size() > kMaxRelaxationDeltas) {
    return absl::InvalidArgumentError(
        absl::StrCat("relaxation_deltas has ", spec.relaxation_deltas.size(),
                     " values; permitted: at most ", kMaxRelaxationDeltas));
  }
  std::vector<PairGeometry> geometries;
  for (const double delta : spec.relaxation_deltas) {
    const absl::StatusOr<PairGeometry> geometry = PairGeometry::Create(spec.rho, delta);
    if (!geometry.ok()) return geometry.status();
    geometries.push_back(*geometry);
  }
  return geometries;
}

absl::Status ValidateEpsilon(double epsilon) {
  if (epsilon > 0 && epsilon < 0.5) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("epsilon is ", NumberText(epsilon), "; permitted: 0 < epsilon < 1/2"));
}

absl::Status ValidateSeconds(double seconds) {
  if (seconds >= kMinSecondsPerCurve && seconds <= kMaxSecondsPerCurve) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("seconds_per_curve is ", NumberText(seconds),
                                                 "; permitted: [", NumberText(kMinSecondsPerCurve),
                                                 ", ", NumberText(kMaxSecondsPerCurve), "]"));
}

}  // namespace

absl::Status CompareMethods(const MethodComparisonSpec& spec, const std::stop_token& stop,
                            const std::function<void(const MethodMeasurement&)>& tell) {
  const absl::StatusOr<PairGeometry> geometry = PairGeometry::Create(spec.rho, spec.delta);
  if (!geometry.ok()) return geometry.status();
  if (absl::Status status = ValidateEpsilon(spec.epsilon); !status.ok()) return status;
  if (absl::Status status = ValidateSeconds(spec.seconds_per_curve); !status.ok()) return status;
  const absl::StatusOr<std::vector<PairGeometry>> relaxing = RelaxingGeometries(spec);
  if (!relaxing.ok()) return relaxing.status();
  if (Comparison(spec, *geometry, *relaxing, stop, tell).Run()) return absl::OkStatus();
  return absl::CancelledError("the comparison of methods was stopped before its end");
}

}  // namespace ballpiston
