// The pair's Lyapunov exponents lambda_1 > lambda_2 > 0 in a unit of time at the energy 1/2, and
// their sum, which is the entropy by Pesin's formula. billiard/tangent_map.h derives the maps of
// tangent vectors, and why the other exponents are 0, 0, -lambda_2, -lambda_1.
//
// A block is many orbits of kOrbit collisions. Each starts from the return map's invariant measure,
// so orbits are independent and in equilibrium. Each is one batch of the batch means: the
// logarithms of its growth over its duration, or over its collisions. Tangent vectors start in
// directions that are the same for every orbit, and turn to those of the exponents by a factor of
// about exp(-2 lambda_2 t), at least 4 in each collision as measured. So the first
// kWarmUpCollisions collisions of an orbit are not measured.
//
// The billiard's lanes follow two tangent vectors. The reference follows six, and reports the other
// four exponents and the sum of all six as they were measured.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/billiard/orbits.h"
#include "core/billiard/tangent_plane.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/pair_experiment.h"
#include "core/gas/pair_tangents.h"
#include "core/statistics/stated_error.h"

namespace ballpiston {
namespace {

// Collisions of an orbit that are measured, and those before them.
constexpr uint64_t kOrbit = 64;
constexpr uint64_t kWarmUpCollisions = 8;

// An orbit is one event for the error.
constexpr double kOrbitsPerCollision = 1.0 / kOrbit;

// The accumulators of a block. Those of the third to the sixth exponent, and of all six, are at the
// end, and only in the reference.
enum Ratio : size_t {
  kFirst,
  kSecond,
  kEntropy,
  kFirstPerCollision,
  kSecondPerCollision,
  kFreeTime,
  kRatios
};
constexpr size_t kFurtherRatios = 5;

// Two of these exponents and the sum are 0. Their rounding is that of the largest exponent.
Reading FurtherRatioAt(size_t index) {
  return [=](const BlockResult& merged) {
    Estimate estimate = *RatioAt(index, kOrbitsPerCollision)(merged);
    const double largest = merged.batch_means[kFirst].Ratio().value_or(0);
    estimate.standard_error = StatedError(kEventsForAnError, largest, estimate.standard_error);
    return estimate;
  };
}

// `Tangents` is TangentPlane or PairTangents.
template <typename Tangents>
struct FollowedOrbit : OrbitInEquilibrium {
  std::optional<Tangents> tangents;
  uint64_t collisions_before = 0;  // in the warm-up
  double time = 0;
  std::array<double, Tangents::kExponents> growth = {};

  static uint64_t LengthIn(const Block&) { return kOrbit; }

  PairState Start(const PairExperiment& experiment, const OrbitSamples& own) {
    const PairState state = OrbitInEquilibrium::Start(experiment, own);
    tangents.emplace(experiment.geometry(), state);
    return state;
  }

  AfterCollision Collide(const PairExperiment&, const Collision& collision) {
    tangents->Collide(collision);
    const auto growths = tangents->TakeGrowth();
    if (collisions_before < kWarmUpCollisions) {
      ++collisions_before;
      return AfterCollision::kGoOn;
    }
    for (size_t k = 0; k < growth.size(); ++k) growth[k] += growths[k];
    time += collision.time;
    return Count();
  }

  void AddTo(const PairExperiment&, BlockResult& result) const {
    if (collisions == 0) return;  // it has escaped
    result.samples += collisions;
    std::vector<BatchMeans>& ratios = result.batch_means;
    const auto count = static_cast<double>(collisions);
    const double first = growth[0], second = growth[1];
    ratios[kFirst].Add(first, time);
    ratios[kSecond].Add(second, time);
    ratios[kEntropy].Add(first + second, time);
    ratios[kFirstPerCollision].Add(first, count);
    ratios[kSecondPerCollision].Add(second, count);
    ratios[kFreeTime].Add(time, count);
    double sum = first + second;
    for (size_t k = 2; k < growth.size(); ++k) {
      ratios[kRatios + k - 2].Add(growth[k], time);
      sum += growth[k];
    }
    if (ratios.size() > kRatios) ratios.back().Add(sum, time);
  }
};

bool IsByReference(Model model) { return model == Model::kBilliardReference; }

std::vector<Measurement> Table(const PairGeometry& geometry, Model model) {
  const auto ratio = [](std::string name, size_t index) {
    return Measurement{.name = std::move(name), .reading = RatioAt(index, kOrbitsPerCollision)};
  };
  std::vector<Measurement> table = {ratio("lyapunov_1", kFirst),
                                    ratio("lyapunov_2", kSecond),
                                    ratio("entropy", kEntropy),
                                    ratio("lyapunov_1_per_collision", kFirstPerCollision),
                                    ratio("lyapunov_2_per_collision", kSecondPerCollision),
                                    ratio("mean_free_time_ball_piston", kFreeTime)};
  table.back().exact = MeanFreeTimesOf(geometry).ball_piston;
  if (IsByReference(model)) {
    for (size_t k = 0; k < kFurtherRatios - 1; ++k) {
      table.push_back({absl::StrCat("lyapunov_", k + 3), FurtherRatioAt(kRatios + k)});
    }
    table.push_back({"lyapunov_sum", FurtherRatioAt(kRatios + kFurtherRatios - 1)});
  }
  return table;
}

class LyapunovExperiment : public PairExperiment {
 public:
  LyapunovExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PairExperiment(spec, point) {
    const size_t ratios = kRatios + (IsByReference(answer().model) ? kFurtherRatios : 0);
    SetMeasurements({.batch_means = std::vector<BatchMeans>(ratios)},
                    Table(geometry(), answer().model));
  }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override {
    if (IsByReference(answer().model)) {
      return RunOrbits<FollowedOrbit<PairTangents>>(queue, *this);
    }
    return RunOrbits<FollowedOrbit<TangentPlane>>(queue, *this);
  }
};

// The times of events with tangent vectors, relative to those without, as measured.
Forecast ForecastOfLyapunov(Model model, const PointParameters& point) {
  const double with_tangents = IsByReference(model) ? 5.3 : 1.5;
  constexpr double kWithWarmUp = static_cast<double>(kWarmUpCollisions + kOrbit) / kOrbit;
  return {.work = WorkOfACollision(GeometryOf(point)).Times(with_tangents * kWithWarmUp),
          .memory = kMemoryOfPairs};
}

// The relative errors are those measured for rho = 0.501 to 0.7 and delta = 0.005 to its bound,
// where they differ by a factor of 1.5.
constexpr Scatter OfOrbits(double error) { return {error, kOrbitsPerCollision}; }

// The scatter of lambda_2: a fit, within a factor of 1.5, to errors that were measured for rho =
// 0.501 to 0.7071 and delta = 0.05 to 1 of its bound. `at_delta_0` and `at_bound` are the errors in
// large cells. In small cells the error near the bound is larger: it grows with
// -log(1/sqrt(2) - rho).
Scatter OfSecond(const PointParameters& point, double at_delta_0, double at_bound) {
  constexpr double kLargest = 2.5, kAtASmallCell = 1.1, kSmallCell = 0.007;
  const double room = std::numbers::sqrt2 / 2 - point[kRho];
  const double in_a_small_cell =
      std::clamp(kAtASmallCell + 0.4 * std::log(kSmallCell / room), at_bound, kLargest);
  const double of_bound = point[kDelta] / PairDeltaBound(point[kRho]);
  const double excess = (in_a_small_cell - at_bound) * of_bound * of_bound;
  return OfOrbits(std::lerp(at_delta_0, at_bound, of_bound) + excess);
}

consteval AimedEstimate Aim(absl::string_view name,
                            Scatter (*scatter)(Model, const PointParameters&)) {
  return {.name = name, .models = kBilliards, .scatter = scatter};
}

constexpr AimedEstimate kAimsOfLyapunov[] = {
    Aim("lyapunov_1", [](Model, const PointParameters&) { return OfOrbits(0.36); }),
    Aim("lyapunov_2", [](Model, const PointParameters& point) { return OfSecond(point, 1, 1); }),
    Aim("entropy", [](Model, const PointParameters&) { return OfOrbits(0.34); }),
    Aim("lyapunov_1_per_collision", [](Model, const PointParameters&) { return OfOrbits(1.2); }),
    Aim("lyapunov_2_per_collision",
        [](Model, const PointParameters& point) { return OfSecond(point, 0.4, 0.76); })};

}  // namespace

constinit const ExperimentKind kLyapunov = {.name = "lyapunov",
                                            .number = 8,
                                            .parameters = kPairAlone,
                                            .aims = kAimsOfLyapunov,
                                            .create = CreateAs<LyapunovExperiment>,
                                            .check_grid = CheckPairGrid,
                                            .forecast = ForecastOfLyapunov,
                                            .samples_together = kOrbit};

}  // namespace ballpiston
