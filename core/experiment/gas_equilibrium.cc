// A periodic gas in equilibrium: the rate at which a ball and a piston exchange energy, the
// temperatures of balls and pistons, the laws of their speeds, and the conductivity by Green and
// Kubo's formula. The model `spectrum` gives the conductivity in the limit of rare exchanges.
//
// Each replica starts from the canonical ensemble, so it needs no relaxation, and its energy has
// the canonical fluctuations. It runs for a fixed time, at most 8 mean times between exchanges of a
// contact (16 by the jump process). Half of that time is the window of the current's
// autocorrelation. A replica runs at temperature 1, and its results are scaled.
// Each replica is a batch of the batch means.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/arithmetic/elementary_functions.h"
#include "core/conductivity/conductivity.h"
#include "core/ensemble/open_blocks.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/expected_limit_error.h"
#include "core/experiment/gas_experiment.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/current_meter.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"
#include "core/gas/jump_current.h"
#include "core/statistics/kl_divergence.h"
#include "core/statistics/stated_error.h"

namespace ballpiston {
namespace {

constexpr size_t kSpeedBins = 120;
constexpr double kMostSpeed = 6;  // one in 10^8 of a ball's speeds is larger, in the last bin

// Replicas of gases with more contacts are too short to measure the conductivity. A smaller gas has
// nearly the same conductivity.
constexpr int64_t kMostContacts = 5000;
bool MeasuresConductivity(const GasGeometry& geometry) {
  return geometry.contacts() <= kMostContacts;
}

// The mean number of exchanges of each contact in a replica. It is small in gases of many contacts,
// because there the energy fluctuates little and starts cost most. The jump process has a longer
// window, because its scatter is smaller than the bias of a shorter window.
double ExchangesOf(Model model, const GasGeometry& geometry) {
  const double most = model == Model::kMarkov ? 16 : 8;
  const double share =
      static_cast<double>(kMostContacts) / static_cast<double>(geometry.contacts());
  return most * std::clamp(share, 1.0 / 16, 1.0);
}

BoundedValue LimitCorrection(const GasGeometry& geometry) {
  return geometry.shape().is_lattice ? kLatticeCorrection : kChainCorrection;
}

double TimeInEquilibrium(Model model, const GasGeometry& geometry) {
  return ExchangesOf(model, geometry) / InfiniteGasExchangeRate(geometry, 1);
}

// The least relative error of a current. That of the jump process is in units of its exchange rate,
// which is rounded.
double RoundingBy(Model model) {
  return model == Model::kMarkov ? kRoundingOfTheRate : kRoundingOfAMean;
}

std::vector<Histogram> EmptySpeeds() { return {2, Histogram::OfBins(0, kMostSpeed, kSpeedBins)}; }

// The bodies, and the laws of their speeds at temperature 1: the probability of a larger speed.
struct BodyLaw {
  const char* name;
  double (*tail)(double speed);
};
constexpr std::array<BodyLaw, 2> kBodies = {
    {{"ball", [](double v) { return std::exp(-v * v / 2); }},
     {"piston", [](double v) { return std::erfc(v * std::numbers::sqrt2 / 2); }}}};

// Exact probabilities of the bins.
std::vector<double> SpeedProbabilities(const BodyLaw& law) {
  const Histogram bins = EmptySpeeds()[0];
  std::vector<double> probabilities;
  for (size_t i = 0; i < kSpeedBins; ++i) {
    const double above = i + 1 == kSpeedBins ? 0 : law.tail(bins.Edge(i + 1));
    probabilities.push_back(law.tail(bins.Edge(i)) - above);
  }
  return probabilities;
}

Estimate SpeedDivergence(const BodyLaw& law, const Histogram& speeds) {
  const KlDivergence divergence = RelativeEntropy(speeds.counts, SpeedProbabilities(law));
  return {.value = divergence.value,
          .standard_error = divergence.standard_error,
          .noise_floor = divergence.noise_floor};
}

// The events of a replica for the errors of its current's correlations (statistics/stated_error.h).
// Few replicas dominate what the jump process measures, those with much energy in few bodies: the
// skewness over replicas is 15 to 20 with three columns or 2x1, 3 with 32, and 60 to 150 in a chain
// of two. One column has no current.
double EventsOfCurrents(Model model, const GasShape& shape) {
  if (model != Model::kMarkov || shape.columns == 1) return 1;
  if (shape.columns == 2 && !shape.is_lattice) return 2e-4;
  return shape.columns * shape.rows < 16 ? 0.05 : 0.1;
}

// The batch means: exchanges over (contacts times duration); the mean energy of a ball; twice the
// mean energy of a piston.
enum GasMean : size_t { kRate, kOfBalls, kOfPistons, kMeansOfAReplica };

// Where moments begin: [0] the conductivity without a test function (gas/jump_current.h); those
// with windows of 0 to kWindow steps; the current's autocorrelation at 1 to kWindow steps.
constexpr size_t kFirstWindow = 1;
constexpr size_t kFirstLag = kFirstWindow + kWindow + 1;
constexpr size_t kMomentsOfCurrents = kFirstLag + kWindow;

constexpr char kConductivity[] = "conductivity";

class GasEquilibrium : public GasExperiment {
 public:
  GasEquilibrium(const EnsembleSpec& spec, const PointParameters& point)
      : GasExperiment(spec, point, PeriodicGasOf(point), point[kTemperature]),
        duration_(WithoutLastBits(TimeInEquilibrium(spec.model, geometry()))),
        events_(EventsOfCurrents(answer().model, geometry().shape())) {
    std::vector<Measurement> table = Table();
    if (HasConductivity()) AddConductivity(table);
    SetMeasurements({.moments = std::vector<Moments>(kMomentsOfCurrents),
                     .batch_means = std::vector<BatchMeans>(kMeansOfAReplica),
                     .histograms = EmptySpeeds()},
                    std::move(table));
  }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override;

  double duration() const { return duration_; }  // of a replica, at temperature 1

  // A meter of the current of a replica with this start; null if the current is not measured.
  std::unique_ptr<CurrentMeter> CurrentOf(const GasState& start) const {
    if (!MeasuresConductivity(geometry())) return nullptr;
    if (gas_engine() == GasEngine::kJumps) {
      return std::make_unique<JumpCurrent>(geometry(), exchange_rate(), start, duration());
    }
    return std::make_unique<CarriedCurrent>(start.balls.size(), exchange_rate(), duration());
  }

  // Adds a replica's numbers.
  void Measure(const GasMeter& meter, BlockResult& result) const {
    AddMeans(meter, result.batch_means);
    if (meter.current() != nullptr) AddCurrent(meter.current()->Result(), result.moments);
    for (size_t i = 0; i < meter.bodies(); ++i) {
      result.histograms[i < meter.balls() ? 0 : 1].Add(std::sqrt(2 * meter.Energy(i)));
    }
  }

  uint64_t CountsOfASample() const override {
    return static_cast<uint64_t>(std::max(geometry().balls(), geometry().pistons()));
  }

 protected:
  void AddDetails(const BlockResult& merged, PointSummary& summary) const override {
    if (answer().model == Model::kSpectrum) {
      const char* const gas = geometry().shape().is_lattice ? "lattice" : "chain";
      summary.remarks = {absl::StrCat("the conductivity is that of the infinite ", gas,
                                      " in the limit of rare exchanges")};
    }
    if (!TakesSamples(answer().model)) return;
    for (size_t i = 0; i < kBodies.size(); ++i) {
      summary.histograms.push_back({.name = absl::StrCat(kBodies[i].name, "_speed"),
                                    .histogram = AtTemperature(merged.histograms[i])});
    }
    if (!HasConductivity()) {
      summary.remarks.push_back(
          absl::StrFormat("the conductivity is not measured in gases of more than %d contacts; "
                          "a smaller gas has nearly the same conductivity",
                          kMostContacts));
      return;
    }
    summary.curves = {
        CurveOf("conductivity_ratio_by_window", kFirstWindow, 0, 1 / StaticConductivity(), merged),
        CurveOf("current_autocorrelation", kFirstLag, 1, AutocorrelationScale(), merged)};
    AddRemarks(merged, summary);
  }

 private:
  void AddMeans(const GasMeter& meter, std::vector<BatchMeans>& means) const {
    means[kRate].Add(static_cast<double>(meter.exchanges()),
                     static_cast<double>(geometry().contacts()) * meter.duration());
    double balls = 0, pistons = 0;
    for (size_t i = 0; i < meter.bodies(); ++i) {
      (i < meter.balls() ? balls : pistons) += meter.MeanEnergy(i);
    }
    means[kOfBalls].Add(balls, static_cast<double>(geometry().balls()));
    means[kOfPistons].Add(2 * pistons, static_cast<double>(geometry().pistons()));
  }

  static void AddCurrent(const GreenKubo& current, std::vector<Moments>& moments) {
    moments[0].Add(current.plain);
    for (size_t i = 0; i <= kWindow; ++i) moments[kFirstWindow + i].Add(current.conductivity[i]);
    for (size_t i = 0; i < kWindow; ++i) moments[kFirstLag + i].Add(current.autocorrelation[i + 1]);
  }

  // Scales at the gas's temperature: of times, of conductivities, and of squared currents of a
  // cell. The currents' energies are in units of the temperature, because its cube may exceed a
  // double.
  double Step() const { return duration() / kCurrentSteps / std::sqrt(temperature()); }
  double ConductivityScale() const { return std::sqrt(temperature()); }
  double AutocorrelationScale() const { return temperature(); }

  // The static conductivity of the infinite gas at temperature 1.
  double StaticConductivity() const { return InfiniteGasExchangeRate(geometry(), 1) / 2; }

  std::vector<Measurement> Table() const {
    std::vector<Measurement> table = {{"exchange_rate", RatioAt(kRate), std::sqrt(temperature())},
                                      {"temperature_ball", RatioAt(kOfBalls), temperature()},
                                      {"temperature_piston", RatioAt(kOfPistons), temperature()}};
    const double rate = GasExchangeRate(geometry(), temperature());
    table[0].exact = rate;
    table[0].known = {rate, kGasExchangeRateRelativeError * rate};
    table[1].exact = table[2].exact = temperature();
    table[1].known = table[2].known = {temperature(), 0};
    if (!TakesSamples(answer().model)) return table;  // without speeds
    for (size_t i = 0; i < kBodies.size(); ++i) {
      table.push_back(
          {absl::StrCat(kBodies[i].name, "_speed_divergence"), [i](const BlockResult& merged) {
             return SpeedDivergence(kBodies[i], merged.histograms[i]);
           }});
    }
    return table;
  }

  // The spectrum knows the conductivity of every gas.
  bool HasConductivity() const {
    if (answer().model == Model::kSpectrum) return true;
    return TakesSamples(answer().model) && MeasuresConductivity(geometry());
  }

  // The mean of the moments with this index.
  Reading OfCurrent(size_t index) const {
    return MeanAt(index, events_, RoundingBy(answer().model));
  }

  // The limit, which is beside measured estimates, is that of the infinite gas.
  void AddConductivity(std::vector<Measurement>& table) const {
    const auto [correction, error] = LimitCorrection(geometry());
    // `of_static`: the static conductivity, in the units of the estimate.
    const auto add = [&](const char* name, double scale, double of_static) {
      Measurement row = {name, OfCurrent(kFirstWindow + kWindow), scale};
      row.known = {of_static * (1 + correction), of_static * error};
      if (TakesSamples(answer().model)) row.limit = row.known->value;
      table.push_back(std::move(row));
    };
    add(kConductivity, ConductivityScale(), InfiniteGasExchangeRate(geometry(), temperature()) / 2);
    add("conductivity_ratio", 1 / StaticConductivity(), 1);
  }

  // The moments from index `first` on are those at times from `first_step` to the window's end.
  Curve CurveOf(const char* name, size_t first, size_t first_step, double scale,
                const BlockResult& merged) const {
    Curve curve = {.name = name};
    for (size_t step = first_step; step <= kWindow; ++step) {
      const Measurement there = {"", OfCurrent(first + step - first_step), scale};
      curve.points.push_back(CurvePointOf(static_cast<double>(step) * Step(), *there.Of(merged)));
    }
    return curve;
  }

  void AddRemarks(const BlockResult& merged, PointSummary& summary) const {
    summary.remarks.push_back(absl::StrFormat(
        "the conductivity includes the current's correlations up to a time of %.3g, %.2g mean "
        "times between exchanges of a ball and a piston",
        kWindow * Step(), ExchangesOf(answer().model, geometry()) * kWindow / kCurrentSteps));
    const bool is_first =
        summary.estimates.front().name == kConductivity;  // Summarize adds its remark
    if (is_first || HasStatedError(events_ * static_cast<double>(merged.samples))) return;
    summary.remarks.push_back(RemarkOnSamples(kConductivity, kEventsForAnError / events_));
  }

  // Speeds scale with sqrt T.
  Histogram AtTemperature(Histogram speeds) const {
    speeds.upper *= std::sqrt(temperature());
    return speeds;
  }

  double duration_;  // rounded, because its last bits depend on the C library
  double events_;    // of a replica, for the errors of its current's correlations
};

// The replicas of a block, which are measured in their order.
struct ReplicasOfBlock {
  uint64_t replicas;
  BlockResult result;

  uint64_t count() const { return replicas; }
  BlockResult Result() { return std::move(result); }
};

// A replica that runs.
struct Replica {
  uint64_t number;  // of OpenBlocks
  double energy_at_start;
  std::unique_ptr<CurrentMeter> current;  // null after the run's meter has taken it
};

// Computes several replicas at a time, of several blocks if these are small, to fill the lanes.
class GasBlocks : public EngineRun {
 public:
  GasBlocks(const GasEquilibrium& experiment, BlockQueue& queue)
      : experiment_(experiment), queue_(queue), blocks_(queue, [&experiment](const Block& block) {
          return ReplicasOfBlock{block.samples, experiment.EmptyResult()};
        }) {}

  bool Advance() override {
    do {
      if (run_ == nullptr) Begin();
      if (run_ == nullptr) return true;
      if (!run_->AdvanceToward(experiment_.duration())) continue;
      for (size_t i = 0; i < running_.size(); ++i) Measure(running_[i], run_->meters()[i]);
      run_.reset();
      running_.clear();
    } while (!queue_.Pause());
    return false;
  }

 private:
  // The other engines run one replica at a time, because more would not make them faster.
  size_t MostTogether(const Block& block) const {
    if (experiment_.gas_engine() != GasEngine::kLanes) return 1;
    return TogetherInLanes(experiment_.geometry().balls(), experiment_.plan(), block.chunk);
  }

  // Starts replicas until the run is full or the queue has no more now. The first replica
  // determines the number of replicas in the run.
  void Begin() {
    std::vector<GasStart> starts;
    for (size_t most = 1; starts.size() < most;) {
      const std::optional<uint64_t> number = blocks_.Next();
      if (!number) break;
      if (starts.empty()) most = MostTogether(blocks_.BlockOf(*number));
      starts.push_back(Draw(*number));
    }
    if (starts.empty()) return;
    run_ = StartGases(experiment_.gas_engine(), experiment_.geometry(), experiment_.exchange_rate(),
                      std::move(starts));
    for (size_t i = 0; i < running_.size(); ++i) {
      run_->meters()[i].MeasureCurrent(std::move(running_[i].current));
    }
  }

  GasStart Draw(uint64_t number) {
    const GasRandom random =
        experiment_.RandomOf(blocks_.BlockOf(number).first + blocks_.IndexOf(number));
    CounterRandom of_start = random.OfStart();
    GasState state = DrawGas(experiment_.geometry(), TemperatureProfile(1), of_start);
    running_.push_back({number, EnergyOf(state), experiment_.CurrentOf(state)});
    return {std::move(state), ThermalWalls(), random};
  }

  void Measure(const Replica& replica, GasMeter& meter) {
    meter.End(experiment_.duration());
    BlockResult& result = blocks_.WorkOf(replica.number).result;
    experiment_.Measure(meter, result);
    result.health.Merge(
        {.escapes = meter.escapes(),
         .max_energy_error = std::fabs(meter.TotalEnergy() / replica.energy_at_start - 1)});
    ++result.samples;
    blocks_.End(replica.number);
  }

  const GasEquilibrium& experiment_;
  BlockQueue& queue_;
  OpenBlocks<ReplicasOfBlock> blocks_;
  std::vector<Replica> running_;
  std::unique_ptr<GasRun> run_;  // of the replicas in running_; null if there are none
};

std::unique_ptr<EngineRun> GasEquilibrium::StartRun(BlockQueue& queue) const {
  return std::make_unique<GasBlocks>(*this, queue);
}

// The current of the jump process costs twice as much as its exchanges; the billiard's current
// costs almost nothing.
Forecast ForecastOfGasEquilibrium(Model model, const PointParameters& point) {
  const GasGeometry geometry = PeriodicGasOf(point);
  SampleWork work = WorkOfReplica(model, geometry, TimeInEquilibrium(model, geometry));
  if (MeasuresConductivity(geometry)) work.jumps *= 3;
  return {.work = work,
          .collisions = static_cast<double>(geometry.contacts()) * ExchangesOf(model, geometry),
          .memory = MemoryOfReplicas(model, point)};
}

// The error has two parts: the random number of exchanges, and the energy of the replica, whose
// root determines the rate.
Scatter ScatterOfTheRate(Model model, const PointParameters& point) {
  const GasGeometry geometry = PeriodicGasOf(point);
  const auto freedom = static_cast<double>(2 * geometry.balls() + geometry.pistons());
  const auto contacts = static_cast<double>(geometry.contacts());
  return {std::sqrt(1.3 / (contacts * ExchangesOf(model, geometry)) + 0.5 / freedom)};
}

// Measured errors. They fall with the number of cells to a constant, because the error of a
// correlation is proportional to its scale; 1 + 1/cells fits small gases. The jump process measures
// only the correction, which is 0 in one column.
double ErrorOfConductivity(Model model, const GasShape& shape) {
  if (model != Model::kMarkov) {
    return (shape.is_lattice ? 1.9 : 2.3) * (1 + 1 / static_cast<double>(shape.cells()));
  }
  if (shape.columns == 1) return 0;
  if (shape.columns == 2) return shape.is_lattice && shape.rows == 1 ? 0.0007 : 0.0003;
  return shape.rows > 1 ? 0.0005 : 0.001;
}

Scatter ScatterOfConductivity(Model model, const PointParameters& point) {
  const GasShape shape = ShapeOf(point[kCells]);
  return {ErrorOfConductivity(model, shape), EventsOfCurrents(model, shape), RoundingBy(model)};
}

// The relative difference between the infinite gas, whose conductivity the spectrum gives, and a
// gas of this shape in the limit. The values are bounds of measured differences
// (docs/research/conductivity.md). In one column no correlation lowers the conductivity.
double ErrorOfSize(const GasGeometry& geometry) {
  constexpr double kOfColumns[] = {0.00182, 5e-4, 2e-4, 7e-5, 4e-5, 2e-5};
  constexpr double kOfRows[] = {2.6e-4, 4e-5};
  constexpr double kOfMore = 1e-5;
  const auto in = [](std::span<const double> errors, int64_t count) {
    const auto n = static_cast<size_t>(count);
    return n <= errors.size() ? errors[n - 1] : kOfMore;
  };
  const GasShape& shape = geometry.shape();
  const double rows = shape.is_lattice ? in(kOfRows, shape.rows) : 0;
  const double rate = GasExchangeRate(geometry, 1) / InfiniteGasExchangeRate(geometry, 1);
  return in(kOfColumns, shape.columns) + rows + std::fabs(rate - 1);
}

std::optional<double> ErrorOfTheLimit(const PointParameters& point) {
  const GasGeometry geometry = PeriodicGasOf(point);
  return ExpectedLimitErrorInAGas(point) + ErrorOfSize(geometry) + LimitCorrection(geometry).error;
}

double ErrorOfTheCorrection(const PointParameters& point) {
  const auto [correction, error] = LimitCorrection(PeriodicGasOf(point));
  return error / (1 + correction);
}

void CheckEquilibriumGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  CheckGasGrid(spec, found);
  if (spec.target.estimate != kConductivity || spec.model == Model::kSpectrum) return;
  const std::vector<double>& cells = spec.grid[kCells];
  for (size_t i = 0; i < cells.size(); ++i) {
    const GasShape shape = ShapeOf(cells[i]);
    if (shape.contacts() <= kMostContacts) continue;
    found.push_back(
        {absl::StrFormat("grid.cells[%d]", i),
         absl::StrFormat("is %s, which has %d contacts; permitted with estimate conductivity: up "
                         "to %d, or model spectrum; a smaller gas has nearly the same conductivity",
                         Text(shape), shape.contacts(), kMostContacts)});
  }
}

std::vector<std::vector<double>> SpeedProbabilitiesAt(const PointParameters&) {
  return {SpeedProbabilities(kBodies[0]), SpeedProbabilities(kBodies[1])};
}

constexpr Model kModelsOfGasEquilibrium[] = {Model::kClosedForm, Model::kSpectrum, Model::kMarkov,
                                             Model::kBilliard, Model::kBilliardReference};
constexpr Model kModelsOfConductivity[] = {Model::kSpectrum, Model::kMarkov, Model::kBilliard,
                                           Model::kBilliardReference};
constexpr absl::string_view kMultiplesOfTheConductivity[] = {"conductivity_ratio"};
constexpr AimedEstimate kAimsOfGasEquilibrium[] = {
    {.name = "exchange_rate",
     .models = kModelsOfGasEquilibrium,
     .scatter = ScatterOfTheRate,
     .numerical_error = [](const PointParameters&) { return kGasExchangeRateRelativeError; }},
    {.name = kConductivity,
     .models = kModelsOfConductivity,
     .scatter = ScatterOfConductivity,
     .limit_error = ErrorOfTheLimit,
     .numerical_error = ErrorOfTheCorrection,
     .multiples = kMultiplesOfTheConductivity}};

}  // namespace

constinit const ExperimentKind kGasEquilibrium = {.name = "gas-equilibrium",
                                                  .number = 6,
                                                  .parameters = kParametersOfAPeriodicGas,
                                                  .aims = kAimsOfGasEquilibrium,
                                                  .create = CreateAs<GasEquilibrium>,
                                                  .check_grid = CheckEquilibriumGrid,
                                                  .forecast = ForecastOfGasEquilibrium,
                                                  .expected_probabilities = SpeedProbabilitiesAt};

}  // namespace ballpiston
