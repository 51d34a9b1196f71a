#include "tools/method_comparison/method_comparison.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/arithmetic/number_text.h"
#include "core/closed_form/ingoing_law.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/expected_returns.h"
#include "core/geometry/pair_geometry.h"
#include "core/markov/relaxation_spectrum.h"
#include "core/statistics/kl_divergence.h"
#include "core/statistics/stated_error.h"
#include "server/processor_time.h"
#include "tools/method_comparison/point_runs.h"
#include "tools/method_comparison/returns.h"
#include "tools/method_comparison/trajectory_horizon.h"

namespace ballpiston::method_comparison {
namespace {

constexpr uint64_t kRungFactor = 4;
constexpr uint64_t kFewestReturns = 16;
constexpr size_t kFewestOrbits = 64;
// Fewer orbits give no error of a relaxation time (experiment/energy_relaxation.cc).
constexpr uint64_t kFewestRelaxations = 512;
// A stretch of each trajectory (experiment/gas_conduction.cc). Fewer are rounded up to this number.
constexpr uint64_t kFewestStretches = 128;

// A rung is run if its expected work is at most this many times seconds_per_curve. Then the largest
// rung takes between 0.5 and 2 times seconds_per_curve.
constexpr double kOverrun = 2;

// The truth of a relaxation time, or of a heat current, may take about this many times
// seconds_per_curve.
constexpr double kTruthTimes = 8;

// For sampled methods: the wall hits that the twins need for the method with the longest horizon,
// 113 bits.
constexpr size_t kTwinHits = 110;

// The methods with orbits of the pair.
std::vector<Method> OrbitMethods() {
  return {FixedSteps(1e-1), FixedSteps(1e-2), FixedSteps(1e-3),     FixedSteps(1e-4),
          kReferenceSingle, kReference,       kReferenceLongDouble, kReferenceQuadruple,
          kLanes,           kLanesSingle};
}

std::vector<Method> GasMethods() {
  return {FixedSteps(1e-1), FixedSteps(1e-2), FixedSteps(1e-3), FixedSteps(1e-4),
          kReference,       kLanes,           kMarkov};
}

// The error of the chi-squared law, plus the scatter that a real divergence adds.
double ErrorOfDivergence(double noise_error, double excess, uint64_t samples) {
  const double bias = std::fmax(excess, 0);
  return std::hypot(noise_error, std::sqrt(2 * bias / static_cast<double>(samples)));
}

class Comparison {
 public:
  Comparison(const MethodComparisonSpec& spec,
             const std::function<void(const MethodMeasurement&)>& tell)
      : spec_(spec),
        geometry_(PairGeometry::Create(spec.rho, spec.delta).value()),
        tell_(tell),
        exact_(ConditionalMeanFreeTime(geometry_, spec.epsilon)),
        probabilities_(IngoingProbabilities(spec.epsilon)) {}

  void Run() {
    CompareReturns(Quantity::kMeanFreeTime);
    CompareReturns(Quantity::kIngoingLaw);
    CompareTrajectories();
    RelaxationSpectrum::Get();  // first, so that no run computes the spectrum
    for (const double delta : spec_.relaxation_deltas) {
      CompareWithTruth(Quantity::kRelaxationTime, delta, kFewestTruthOrbits, kFewestRelaxations,
                       {kLanes, kMarkov, kSpectrum},
                       RelaxationRuns(PairGeometry::Create(spec_.rho, delta).value(), spec_.seed));
    }
    const double delta = GasDelta(spec_.rho);
    CompareWithTruth(Quantity::kHeatCurrent, delta, kFewestTruthStretches, kFewestStretches,
                     GasMethods(), HeatCurrentRuns(spec_.rho, delta, spec_.seed));
  }

 private:
  double Limit() const { return kOverrun * spec_.seconds_per_curve; }

  RandomStream Stream(Quantity quantity, uint64_t rung) const {
    return {spec_.seed, (static_cast<uint64_t>(quantity) << 32) | rung};
  }

  void Tell(MethodMeasurement measurement) const {
    const double error = measurement.statistical_error;
    if (measurement.quantity != Quantity::kTrajectory) {
      measurement.bias_resolved = measurement.value > kResolved * error;
    }
    tell_(measurement);
  }

  // Makes and tells runs of increasing numbers of samples, beginning with `samples`. `expected`:
  // the seconds of the first run. A run without a sample is not told.
  template <typename Run>
  void Climb(uint64_t samples, double expected, const Run& run,
             size_t most_rungs = SIZE_MAX) const {
    for (size_t rung = 0; rung < most_rungs && expected <= Limit();
         ++rung, samples *= kRungFactor) {
      const MethodMeasurement measurement = run(rung, samples);
      expected = measurement.work * kRungFactor;
      if (measurement.samples > 0) Tell(measurement);
    }
  }

  void CompareReturns(Quantity quantity) {
    for (const Method& method : OrbitMethods()) {
      Climb(kFewestReturns, PredictedSeconds(method, geometry_, spec_.epsilon, kFewestReturns),
            [&](size_t rung, uint64_t samples) {
              return Measured(
                  quantity, method,
                  RunReturns(method, geometry_, spec_.epsilon, Stream(quantity, rung), samples));
            });
    }
    Tell(ClosedForm(quantity));
  }

  MethodMeasurement Measured(Quantity quantity, const Method& method,
                             const ReturnStatistics& returns) {
    MethodMeasurement measurement = {.method = method,
                                     .quantity = quantity,
                                     .delta = spec_.delta,
                                     .samples = returns.times.count,
                                     .wall_hits = returns.wall_hits,
                                     .work = returns.seconds};
    if (returns.times.count == 0) return measurement;
    if (quantity == Quantity::kMeanFreeTime) {
      measurement.value = std::fabs(returns.times.mean - exact_) / exact_;
      measurement.statistical_error = ErrorOfMean(returns.times) / exact_;
    } else {
      const KlDivergence kl = RelativeEntropy(returns.IngoingCounts(), probabilities_);
      measurement.value = kl.value - kl.noise_floor;
      measurement.statistical_error =
          ErrorOfDivergence(kl.noise_error, measurement.value, returns.times.count);
    }
    measurement.own_error = measurement.statistical_error;
    return measurement;
  }

  double ErrorOfMean(const Moments& times) {
    const double count = static_cast<double>(times.count);
    const double long_returns = count * LongReturnsPerSample(geometry_, spec_.epsilon);
    if (HasStatedError(long_returns)) return times.StandardError().value_or(0);
    return std::sqrt(VarianceOfTimes() / count);
  }

  // The variance from enough returns to determine it, or from as many returns as the time permits.
  double VarianceOfTimes() {
    constexpr double kFewest = 256, kMost = 65536;
    if (variance_of_times_) return *variance_of_times_;
    const double affordable =
        spec_.seconds_per_curve / PredictedSeconds(kLanes, geometry_, spec_.epsilon, 1);
    const double wanted = kEventsForAnError / LongReturnsPerSample(geometry_, spec_.epsilon);
    const double samples = std::clamp(wanted, kFewest, std::clamp(affordable, kFewest, kMost));
    const ReturnStatistics returns =
        RunReturns(kLanes, geometry_, spec_.epsilon, {spec_.seed, ~uint64_t{0}},
                   static_cast<uint64_t>(samples));
    return variance_of_times_.emplace(returns.times.Variance().value_or(0));
  }

  // If each cell of a law has a relative error e, the divergence of the law is at most e^2/2.
  MethodMeasurement ClosedForm(Quantity quantity) const {
    MethodMeasurement measurement = {
        .method = kClosedForm, .quantity = quantity, .delta = spec_.delta};
    if (quantity == Quantity::kMeanFreeTime) {
      measurement.work =
          server::SecondsOf([&] { ConditionalMeanFreeTime(geometry_, spec_.epsilon); });
      measurement.value = kMeanFreeTimeRelativeError + kConditionalRateRelativeError;
    } else {
      measurement.work = server::SecondsOf([&] { IngoingProbabilities(spec_.epsilon); });
      measurement.value = kIngoingLawRelativeError * kIngoingLawRelativeError / 2;
    }
    return measurement;
  }

  // All methods use the same twins. The twins cost more than any method and therefore determine the
  // number of orbits.
  void CompareTrajectories() {
    std::vector<TwinOrbits> rungs;
    double expected = 0;
    for (size_t orbits = kFewestOrbits; expected <= Limit(); orbits *= kRungFactor) {
      const double begin = server::ThreadSeconds();
      rungs.emplace_back(geometry_, Stream(Quantity::kTrajectory, rungs.size()), orbits);
      rungs.back().FlyAhead(kTwinHits);
      expected = (server::ThreadSeconds() - begin) * kRungFactor;
    }
    for (const Method& method : OrbitMethods()) {
      const auto run = [&](size_t rung, uint64_t) {
        return Measured(method, HorizonOf(method, geometry_, rungs[rung]));
      };
      Climb(kFewestOrbits, 0, run, rungs.size());
    }
  }

  MethodMeasurement Measured(const Method& method, const TrajectoryHorizon& horizon) const {
    const double error = horizon.hits.StandardError().value_or(0);
    return {.method = method,
            .quantity = Quantity::kTrajectory,
            .delta = spec_.delta,
            .samples = horizon.hits.count,
            .wall_hits = horizon.wall_hits,
            .work = horizon.seconds,
            .value = horizon.hits.mean,
            .statistical_error = error,
            .own_error = error};
  }

  // Compares methods with a truth. Does nothing if the truth would have fewer samples than
  // `fewest_truth_samples`. The truth's time is long enough for the first run of any engine, which
  // has `fewest_samples`.
  void CompareWithTruth(Quantity quantity, double delta, uint64_t fewest_truth_samples,
                        uint64_t fewest_samples, const std::vector<Method>& methods,
                        const PointRuns& runs) const {
    const uint64_t truth_samples = SamplesOfTruth(runs.PredictedSecondsPerSample(kLanes));
    if (truth_samples < fewest_truth_samples) return;
    const PointEstimate truth = runs.Truth(truth_samples);
    for (const Method& method : methods) {
      const auto run = [&](size_t, uint64_t samples) {
        return Compared(method, quantity, delta, runs.Run(method, samples), truth);
      };
      if (method == kSpectrum) {
        Tell(run(0, 0));
      } else if (method.time_step > 0) {
        Climb(kFewestOrbits, runs.PredictedSecondsPerSample(method) * kFewestOrbits, run);
      } else {
        Climb(fewest_samples, 0, run);
      }
    }
  }

  static MethodMeasurement Compared(const Method& method, Quantity quantity, double delta,
                                    const PointEstimate& measured, const PointEstimate& truth) {
    const double ratio = measured.value / truth.value;
    return {.method = method,
            .quantity = quantity,
            .delta = delta,
            .samples = measured.error == 0 ? 0 : measured.samples,  // nearly all were lost
            .work = measured.seconds,
            .value = std::fabs(ratio - 1),
            .statistical_error = std::hypot(measured.error, ratio * truth.error) / truth.value,
            .own_error = measured.error / truth.value};
  }

  // The power of two whose logarithm is nearest. It follows from the predicted cost, not from a
  // measured cost. Therefore the truth depends only on the spec.
  uint64_t SamplesOfTruth(double seconds_per_sample) const {
    const double samples = kTruthTimes * spec_.seconds_per_curve / seconds_per_sample;
    return std::bit_floor(static_cast<uint64_t>(std::numbers::sqrt2 * samples));
  }

  const MethodComparisonSpec spec_;
  const PairGeometry geometry_;
  const std::function<void(const MethodMeasurement&)>& tell_;
  const double exact_;
  const std::vector<double> probabilities_;
  std::optional<double> variance_of_times_;
};

// If rho is not permitted, checks only what does not depend on rho.
absl::Status ValidateDelta(double rho, double delta) {
  return ValidateRho(rho).ok() ? ValidatePairDelta(rho, delta) : ValidatePositiveDelta(delta);
}

}  // namespace

std::vector<std::string> Violations(const MethodComparisonSpec& spec) {
  std::vector<std::string> violations;
  const auto permit = [&](bool permitted, const std::string& violation) {
    if (!permitted) violations.push_back(violation);
  };
  const auto check = [&](const char* flag, const absl::Status& status) {
    permit(status.ok(), absl::StrCat(flag, ": ", status.message()));
  };
  check("--rho", ValidateRho(spec.rho));
  check("--delta", ValidateDelta(spec.rho, spec.delta));
  permit(spec.relaxation_deltas.size() <= kMaxRelaxationDeltas,
         absl::StrCat("--relaxation-delta: ", spec.relaxation_deltas.size(),
                      " values; permitted: at most ", kMaxRelaxationDeltas));
  for (const double delta : spec.relaxation_deltas) {
    check("--relaxation-delta", ValidateDelta(spec.rho, delta));
  }
  permit(spec.epsilon > 0 && spec.epsilon < 0.5,
         absl::StrCat("--epsilon: ", NumberText(spec.epsilon), " is not in (0, 1/2)"));
  permit(spec.seconds_per_curve >= kMinSecondsPerCurve &&
             spec.seconds_per_curve <= kMaxSecondsPerCurve,
         absl::StrCat("--seconds: ", NumberText(spec.seconds_per_curve), " is not in [",
                      NumberText(kMinSecondsPerCurve), ", ", NumberText(kMaxSecondsPerCurve), "]"));
  return violations;
}

std::vector<double> DefaultRelaxationDeltas(double rho) {
  std::vector<double> deltas = {0.2, 0.1, 0.05, 0.025};
  std::erase_if(deltas, [rho](double delta) { return !ValidateDelta(rho, delta).ok(); });
  return deltas;
}

double GasDelta(double rho) {
  constexpr double kUsual = 0.2;
  return ValidateGasDelta(rho, kUsual).ok() ? kUsual : GasDeltaBound(rho);
}

void CompareMethods(const MethodComparisonSpec& spec,
                    const std::function<void(const MethodMeasurement&)>& tell) {
  Comparison(spec, tell).Run();
}

}  // namespace ballpiston::method_comparison
