// The positive Lyapunov exponents of a periodic gas, and their sum, which is the entropy by Pesin's
// formula, by the reference's events (gas/gas_tangents.h). The negative exponents are these with
// the opposite sign; two are 0.
//
// An exponent depends on the energy only by the factor sqrt E. So its canonical mean is its value
// at the energy whose root is the canonical mean, and every replica has this energy:
//   sqrt E = sqrt T gamma(f/2 + 1/2)/gamma(f/2),   f degrees of freedom.
// A replica starts from the canonical ensemble, with its velocities scaled to this energy. During
// its warm-up the tangent vectors turn to their directions. The time after the warm-up is one batch
// of the batch means. Replicas run at temperature 1, and results are scaled.
//
// lambda_2 to lambda_N of N >= 3 balls have no standard error. Which vector takes over which ball
// can depend on components below the rounding of larger ones: between numbers of 53 and of 64 bits
// these exponents differ by 0.4 % (lambda_8 of eight cells) and less, and the others in no digit of
// six.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/arithmetic/elementary_functions.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/gas_experiment.h"
#include "core/experiment/pair_experiment.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_tangents.h"
#include "core/gas/hit_rates.h"

namespace ballpiston {
namespace {

// The computing time of a replica grows as the third power of the number of cells, or faster.
constexpr int64_t kMostCells = 32;

// The batch means: of the entropy, of the exchanges, and of the exponents.
enum GasRatio : size_t { kEntropyOfAll, kExchanges, kFirstExponent };

// The times of a replica at temperature 1. The last vectors have their directions after 3 mean
// times between exchanges of a ball and a piston with one column, and after 20 with 16, as
// measured.
struct Times {
  explicit Times(const GasGeometry& geometry)
      : start(WithoutLastBits(WarmUp(geometry) / InfiniteGasExchangeRate(geometry, 1))),
        end(kWarmUps * start) {}

  // The exchanges of a ball and a piston, on average.
  static double WarmUp(const GasGeometry& geometry) {
    return 8 + static_cast<double>(std::max(geometry.shape().columns, geometry.shape().rows));
  }
  static double Exchanges(const GasGeometry& geometry) {
    return static_cast<double>(geometry.contacts()) * kWarmUps * WarmUp(geometry);
  }

  static constexpr double kWarmUps = 3;  // of which the first is not measured

  double start;  // of the measurement
  double end;
};

// The energy whose root is the canonical mean at temperature 1.
double MeanEnergy(const GasGeometry& geometry) {
  const auto f = static_cast<double>(DegreesOfFreedom(geometry));
  const bool is_odd = std::fmod(f, 2) != 0;
  double root = is_odd ? 1 / std::sqrt(std::numbers::pi) : std::sqrt(std::numbers::pi) / 2;
  for (double k = is_odd ? 1 : 2; k < f; k += 2) root *= (k + 1) / k;
  return root * root;
}

GasState DrawAtEnergy(const GasGeometry& geometry, double energy, CounterRandom random) {
  GasState state = DrawGas(geometry, TemperatureProfile(1), random);
  const double factor = std::sqrt(energy / EnergyOf(state));
  for (GasBall& ball : state.balls) ball.speed *= factor;
  for (GasPiston& piston : state.pistons) piston.velocity *= factor;
  return state;
}

// A gas with its tangent vectors.
class FollowedGas {
 public:
  FollowedGas(const GasGeometry& geometry, const GasState& start)
      : gas_(geometry, start, ThermalWalls()),
        tangents_(geometry.pair().rho(), start, VelocitiesAcross(start)),
        energy_at_start_(EnergyOf(start)) {}

  // Returns false after some events, 8 ms with the most cells; then it must be called again.
  bool AdvanceToward(double time) {
    constexpr int kEventsOfACall = 256;
    for (int i = 0; i < kEventsOfACall; ++i) {
      if (gas_.NextTime() > time) return true;
      const GasEvent event = gas_.Step();
      tangents_.Follow(event, gas_);
      if (event.kind == EventKind::kBallPiston) ++exchanges_;
      if (event.kind == EventKind::kEscape) ++escapes_;
    }
    return false;
  }

  // Since the last call.
  std::vector<double> TakeGrowth(double time) { return tangents_.TakeGrowth(time); }
  uint64_t TakeExchanges() { return std::exchange(exchanges_, 0); }

  Health HealthAt(double time) const {
    return {.escapes = escapes_,
            .max_energy_error = std::fabs(EnergyOf(gas_.StateAt(time)) / energy_at_start_ - 1)};
  }

 private:
  ReferenceGas gas_;
  GasTangents tangents_;
  double energy_at_start_;
  uint64_t exchanges_ = 0;
  uint64_t escapes_ = 0;
};

// Whether rounding changes lambda_(k+1).
bool IsRounded(size_t k, const GasGeometry& geometry) {
  const auto balls = static_cast<size_t>(geometry.balls());
  return balls > 2 && k > 0 && k < balls;
}

std::vector<Measurement> Table(const GasGeometry& geometry, double temperature) {
  const double scale = std::sqrt(temperature);
  const auto exponent = [&](size_t k) {
    const Reading reading = RatioAt(kFirstExponent + k, IsRounded(k, geometry) ? 0 : 1);
    return Measurement{absl::StrCat("lyapunov_", k + 1), reading, scale};
  };
  std::vector<Measurement> table = {
      exponent(0),
      {"entropy_per_ball", RatioAt(kEntropyOfAll), scale / static_cast<double>(geometry.balls())},
      {"exchange_rate", RatioAt(kExchanges), scale}};
  table[2].exact = GasExchangeRate(geometry, temperature);
  for (size_t k = 1; k + 1 < DegreesOfFreedom(geometry); ++k) table.push_back(exponent(k));
  return table;
}

// The time that an event takes with its tangent vectors, measured with 1 to 32 cells.
double NanosecondsOfAnEvent(const GasGeometry& geometry) {
  const auto f = static_cast<double>(DegreesOfFreedom(geometry));
  return 70 + 37 * f + 1.7 * f * f;
}

class GasLyapunov : public GasExperiment {
 public:
  GasLyapunov(const EnsembleSpec& spec, const PointParameters& point)
      : GasExperiment(spec, point, PeriodicGasOf(point), point[kTemperature]),
        energy_(MeanEnergy(geometry())) {
    const size_t exponents = DegreesOfFreedom(geometry()) - 1;
    SetMeasurements({.batch_means = std::vector<BatchMeans>(kFirstExponent + exponents)},
                    Table(geometry(), temperature()));
  }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override;

  FollowedGas Start(uint64_t sample) const {
    return {geometry(), DrawAtEnergy(geometry(), energy_, RandomOf(sample).OfStart())};
  }

  // The growth and the exchanges of a replica in a time.
  void Measure(const std::vector<double>& growth, uint64_t exchanges, double time,
               BlockResult& result) const {
    std::vector<BatchMeans>& ratios = result.batch_means;
    ratios[kEntropyOfAll].Add(std::accumulate(growth.begin(), growth.end(), 0.0), time);
    ratios[kExchanges].Add(static_cast<double>(exchanges),
                           static_cast<double>(geometry().contacts()) * time);
    for (size_t k = 0; k < growth.size(); ++k) ratios[kFirstExponent + k].Add(growth[k], time);
  }

 protected:
  void AddDetails(const BlockResult&, PointSummary& summary) const override {
    if (geometry().balls() <= 2) return;
    summary.remarks.push_back(absl::StrFormat(
        "lyapunov_2 to lyapunov_%d have no standard errors, because they depend on rounding; the "
        "others do not",
        geometry().balls()));
  }

 private:
  double energy_;
};

// One replica after the other.
class FollowedGases : public EngineRun {
 public:
  FollowedGases(const GasLyapunov& experiment, BlockQueue& queue)
      : experiment_(experiment), queue_(queue), times_(experiment.geometry()) {}

  bool Advance() override {
    do {
      if (!block_ && !Begin()) return true;
      if (!gas_->AdvanceToward(is_warm_ ? times_.end : times_.start)) continue;
      is_warm_ ? EndReplica() : EndWarmUp();
    } while (!queue_.Pause());
    return false;
  }

 private:
  bool Begin() {
    block_ = queue_.Next();
    if (!block_) return false;
    result_ = experiment_.EmptyResult();
    gas_.emplace(experiment_.Start(block_->first));
    return true;
  }

  void EndWarmUp() {
    gas_->TakeGrowth(times_.start);
    gas_->TakeExchanges();
    is_warm_ = true;
  }

  void EndReplica() {
    experiment_.Measure(gas_->TakeGrowth(times_.end), gas_->TakeExchanges(),
                        times_.end - times_.start, result_);
    result_.health.Merge(gas_->HealthAt(times_.end));
    is_warm_ = false;
    if (++result_.samples < block_->samples) {
      gas_.emplace(experiment_.Start(block_->first + result_.samples));
    } else {
      queue_.Done(*std::exchange(block_, std::nullopt), std::move(result_));
    }
  }

  const GasLyapunov& experiment_;
  BlockQueue& queue_;
  Times times_;
  std::optional<Block> block_;
  BlockResult result_;  // of the block's replicas so far
  std::optional<FollowedGas> gas_;
  bool is_warm_ = false;
};

std::unique_ptr<EngineRun> GasLyapunov::StartRun(BlockQueue& queue) const {
  return std::make_unique<FollowedGases>(*this, queue);
}

void CheckCells(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  CheckGasGrid(spec, found);
  const std::vector<double>& cells = spec.grid[kCells];
  for (size_t i = 0; i < cells.size(); ++i) {
    const GasShape shape = ShapeOf(cells[i]);
    if (shape.cells() <= kMostCells) continue;
    found.push_back({absl::StrFormat("grid.cells[%d]", i),
                     absl::StrFormat("is %s; permitted for gas-lyapunov: 1 to %d cells",
                                     Text(shape), kMostCells)});
  }
}

// Both models are the reference with its tangent vectors. `wall_hit`: the nanoseconds of a wall hit
// in the engine that the model has in other experiments.
Forecast ForecastOfGasLyapunov(Model model, const PointParameters& point) {
  const GasGeometry geometry = PeriodicGasOf(point);
  const auto f = static_cast<double>(DegreesOfFreedom(geometry));
  const double wall_hit = model == Model::kBilliardReference ? 60 : 2.7;
  const double time = Times(geometry).end;
  const HitRates rates = HitRatesOf(geometry.pair());
  const double events = time * (rates.of_a_ball * static_cast<double>(geometry.balls()) +
                                rates.of_a_piston * static_cast<double>(geometry.pistons())) +
                        Times::Exchanges(geometry);
  const double of_tangents = 40 * f * (f + 2);  // bytes
  return {.work = {.ball_wall = events * NanosecondsOfAnEvent(geometry) / wall_hit,
                   .starts = static_cast<double>(geometry.balls()),
                   .together = 1},
          .collisions = Times::Exchanges(geometry),
          .memory = MemoryOfReplicas(Model::kBilliardReference, point) + of_tangents};
}

// Measured with chains of 1 to 16 cells at deltas of 0.05 to 0.2.
Scatter ScatterOfTheFirst(Model, const PointParameters&) { return {0.055}; }
Scatter ScatterOfTheEntropy(Model, const PointParameters& point) {
  return {0.053 * std::pow(static_cast<double>(ShapeOf(point[kCells]).cells()), -0.45)};
}

constexpr AimedEstimate kAimsOfGasLyapunov[] = {
    {.name = "lyapunov_1", .models = kBilliards, .scatter = ScatterOfTheFirst},
    {.name = "entropy_per_ball", .models = kBilliards, .scatter = ScatterOfTheEntropy}};

}  // namespace

constinit const ExperimentKind kGasLyapunov = {.name = "gas-lyapunov",
                                               .number = 9,
                                               .parameters = kParametersOfAPeriodicGas,
                                               .aims = kAimsOfGasLyapunov,
                                               .create = CreateAs<GasLyapunov>,
                                               .check_grid = CheckCells,
                                               .forecast = ForecastOfGasLyapunov};

}  // namespace ballpiston
