// A periodic gas in equilibrium: how often a ball and a piston exchange energy, the temperatures of
// balls and pistons, and the laws of their speeds. By the spectrum also the conductivity in the
// limit of rare exchanges.
//
// Each replica starts from the canonical ensemble, so nothing has to be burnt in, and its energy
// fluctuates as it should. It is followed until a ball and a piston have exchanged some times. It
// runs at temperature 1: all of the gas scales.
//   batch means, a replica each  [0] exchanges, contacts times duration
//                                [1] sum of the balls' mean energies, balls  [2] twice the pistons'
//   histograms                   [0] speeds of the balls at the end  [1] of the pistons
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/conductivity/conductivity.h"
#include "core/ensemble/computed_answer.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/exact_estimate.h"
#include "core/experiment/expected_limit_error.h"
#include "core/experiment/gas_experiment.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/statistics/kl_divergence.h"

namespace ballpiston {
namespace {

constexpr size_t kSpeedBins = 120;
constexpr double kMostSpeed = 6;  // beyond it one in 10^8 of a ball's speeds, in the last bin

// A replica's exchanges, of a contact. Few where there are many contacts, because then the energy
// fluctuates little and starts cost most.
double ExchangesOf(const GasGeometry& geometry) {
  return std::clamp(4e4 / static_cast<double>(geometry.contacts()), 0.5, 4.0);
}

GasTimes TimesInEquilibrium(const GasGeometry& geometry) {
  return {.measure = ExchangesOf(geometry) / InfiniteGasExchangeRate(geometry, 1)};
}

std::vector<Histogram> EmptySpeeds() { return {2, Histogram::OfBins(0, kMostSpeed, kSpeedBins)}; }

// Exact probabilities of the bins, of a law that is 1 - tail(speed) below a speed.
std::vector<double> SpeedProbabilities(double (*tail)(double)) {
  const Histogram bins = EmptySpeeds()[0];
  std::vector<double> probabilities;
  for (size_t i = 0; i < kSpeedBins; ++i) {
    const double above = i + 1 == kSpeedBins ? 0 : tail(bins.Edge(i + 1));
    probabilities.push_back(tail(bins.Edge(i)) - above);
  }
  return probabilities;
}

std::array<std::vector<double>, 2> SpeedLaws() {
  return {SpeedProbabilities([](double v) { return std::exp(-v * v / 2); }),
          SpeedProbabilities([](double v) { return std::erfc(v * std::numbers::sqrt2 / 2); })};
}

BlockResult NoGasesMeasured() {
  BlockResult result;
  result.batch_means.resize(3);
  result.histograms = EmptySpeeds();
  return result;
}

constexpr char kConductivity[] = "conductivity";

bool AimsAtConductivity(const EnsembleSpec& spec) { return AimOf(spec).name == kConductivity; }

class GasEquilibrium : public GasExperiment {
 public:
  GasEquilibrium(const EnsembleSpec& spec, const PointParameters& point,
                 const GasGeometry& geometry)
      : GasExperiment(spec, point, geometry, TimesInEquilibrium(geometry)),
        temperature_(point[kTemperature]),
        exact_rate_(GasExchangeRate(geometry, temperature_)),
        aims_at_conductivity_(AimsAtConductivity(spec)) {}

  GasState Draw(CounterRandom& random) const override {
    return DrawGas(geometry(), TemperatureProfile(1), random);
  }

  void Measure(const GasMeter& meter, BlockResult& result) const override {
    AddMeans(meter, 0, result);
    for (size_t i = 0; i < meter.bodies(); ++i) {
      result.histograms[i < meter.balls() ? 0 : 1].Add(std::sqrt(2 * meter.Energy(i)));
    }
  }

  BlockResult EmptyResult() const override { return NoGasesMeasured(); }

  uint64_t CountsOfASample() const override {
    return static_cast<uint64_t>(std::max(geometry().balls(), geometry().pistons()));
  }

  Estimate FirstEstimate(const BlockResult& merged) const override {
    return aims_at_conductivity_ ? Conductivity(merged) : ExchangeRate(merged);
  }

  PointSummary Summarize(const BlockResult& merged) const override {
    PointSummary summary = {.samples = merged.samples, .health = merged.health};
    if (aims_at_conductivity_) summary.estimates.push_back(Conductivity(merged));
    summary.estimates.insert(
        summary.estimates.end(),
        {ExchangeRate(merged),
         MeanBeside(temperature_, "temperature_ball", merged, 1, temperature_),
         MeanBeside(temperature_, "temperature_piston", merged, 2, temperature_)});
    const auto laws = SpeedLaws();
    constexpr std::array<const char*, 2> kBodies = {"ball", "piston"};
    for (size_t i = 0; i < laws.size(); ++i) {
      const KlDivergence divergence = RelativeEntropy(merged.histograms[i].counts, laws[i]);
      summary.estimates.push_back({.name = absl::StrCat(kBodies[i], "_speed_divergence"),
                                   .value = divergence.value,
                                   .standard_error = divergence.standard_error,
                                   .noise_floor = divergence.noise_floor});
      summary.histograms.push_back(
          {.name = absl::StrCat(kBodies[i], "_speed"), .histogram = AtTemperature(merged, i)});
    }
    return summary;
  }

 private:
  Estimate ExchangeRate(const BlockResult& merged) const {
    return MeanBeside(exact_rate_, "exchange_rate", merged, 0, std::sqrt(temperature_));
  }

  Estimate Conductivity(const BlockResult&) const {
    return {.name = kConductivity, .value = std::numeric_limits<double>::quiet_NaN()};
  }

  // Speeds scale with sqrt T.
  Histogram AtTemperature(const BlockResult& merged, size_t index) const {
    Histogram speeds = merged.histograms[index];
    speeds.upper *= std::sqrt(temperature_);
    return speeds;
  }

  Estimate MeanBeside(double exact, const char* name, const BlockResult& merged, size_t index,
                      double scale) const {
    Estimate mean = Mean(name, merged, index, scale);
    mean.exact = exact;
    return mean;
  }

  double temperature_;
  double exact_rate_;
  bool aims_at_conductivity_;
};

GasGeometry PeriodicGasOf(const PointParameters& point) {
  return GasGeometryOf(point, GasEnds::kPeriodic);
}

PointSummary ExactAnswer(const GasGeometry& geometry, double temperature) {
  return {.estimates = {ExactEstimate("exchange_rate", GasExchangeRate(geometry, temperature),
                                      kGasExchangeRateRelativeError),
                        ExactEstimate("temperature_ball", temperature, 0),
                        ExactEstimate("temperature_piston", temperature, 0)}};
}

// Of the infinite gas in the limit of rare exchanges.
std::vector<Estimate> ConductivityOfLimit(const GasGeometry& geometry, double temperature) {
  const bool is_lattice = geometry.shape().is_lattice;
  const ExtrapolatedValue correction = is_lattice ? kLatticeCorrection : kChainCorrection;
  const double of_static = InfiniteGasExchangeRate(geometry, temperature) / 2;
  const auto in = [&](const char* name, double unit) {
    return Estimate{.name = name,
                    .value = unit * (1 + correction.value),
                    .standard_error = unit * correction.error};
  };
  return {in(kConductivity, of_static), in("conductivity_ratio", 1)};
}

// The closed forms, and the conductivity before or after them.
PointSummary BySpectrum(const EnsembleSpec& spec, const GasGeometry& geometry, double temperature) {
  PointSummary summary = ExactAnswer(geometry, temperature);
  const std::vector<Estimate> limit = ConductivityOfLimit(geometry, temperature);
  const auto place = AimsAtConductivity(spec) ? summary.estimates.begin() : summary.estimates.end();
  summary.estimates.insert(place, limit.begin(), limit.end());
  summary.remarks.push_back(absl::StrCat("the conductivity is that of the infinite ",
                                         geometry.shape().is_lattice ? "lattice" : "chain",
                                         " in the limit of rare exchanges"));
  return summary;
}

std::unique_ptr<PointExperiment> CreateGasEquilibrium(const EnsembleSpec& spec,
                                                      const PointParameters& point) {
  const GasGeometry geometry = PeriodicGasOf(point);
  if (TakesSamples(spec.model)) {
    return std::make_unique<GasEquilibrium>(spec, point, geometry);
  }
  PointSummary summary = spec.model == Model::kSpectrum
                             ? BySpectrum(spec, geometry, point[kTemperature])
                             : ExactAnswer(geometry, point[kTemperature]);
  return std::make_unique<ComputedAnswer>(spec, point, std::move(summary));
}

SampleWork WorkOfGasEquilibrium(Model model, const PointParameters& point) {
  const GasGeometry geometry = PeriodicGasOf(point);
  return WorkOfReplica(model, geometry, TimesInEquilibrium(geometry).Total());
}

double ExchangesOfASample(const PointParameters& point) {
  const GasGeometry geometry = PeriodicGasOf(point);
  return static_cast<double>(geometry.contacts()) * ExchangesOf(geometry);
}

// Exchanges that come by chance, and the energy of the replica, whose root is in the rate.
double ErrorOfGasEquilibrium(const PointParameters& point) {
  const GasGeometry geometry = PeriodicGasOf(point);
  const auto freedom = static_cast<double>(2 * geometry.balls() + geometry.pistons());
  return std::sqrt(1.3 / ExchangesOfASample(point) + 0.5 / freedom);
}

double ErrorOfConductivity(const PointParameters&) { return 1; }

std::vector<std::vector<double>> SpeedProbabilitiesAt(const PointParameters&) {
  const auto laws = SpeedLaws();
  return {laws.begin(), laws.end()};
}

constexpr ParameterUse kParametersOfGasEquilibrium[] = {
    {&kRho}, {&kDelta}, {&kCells}, {&kTemperature}};
constexpr Model kModelsOfGasEquilibrium[] = {Model::kClosedForm, Model::kSpectrum, Model::kMarkov,
                                             Model::kBilliard, Model::kBilliardReference};
constexpr Model kModelsOfConductivity[] = {Model::kSpectrum, Model::kMarkov, Model::kBilliard,
                                           Model::kBilliardReference};
constexpr LimitError kLimitErrorOfConductivity = {
    .model = Model::kSpectrum,
    .has_pilots = false,
    .is_known = [](const PointParameters&) { return true; },
    .expected = ExpectedLimitErrorOfConduction};
constexpr AimedEstimate kAimsOfGasEquilibrium[] = {
    {.name = "exchange_rate", .models = kModelsOfGasEquilibrium, .error = ErrorOfGasEquilibrium},
    {.name = kConductivity,
     .models = kModelsOfConductivity,
     .error = ErrorOfConductivity,
     .limit_error = &kLimitErrorOfConductivity}};

}  // namespace

constinit const ExperimentKind kGasEquilibrium = {.name = "gas-equilibrium",
                                                  .number = 6,
                                                  .parameters = kParametersOfGasEquilibrium,
                                                  .unit = TargetUnit::kEither,
                                                  .models = kModelsOfGasEquilibrium,
                                                  .aims = kAimsOfGasEquilibrium,
                                                  .create = CreateGasEquilibrium,
                                                  .check_grid = CheckGasGrid,
                                                  .work = WorkOfGasEquilibrium,
                                                  .collisions = ExchangesOfASample,
                                                  .expected_probabilities = SpeedProbabilitiesAt};

}  // namespace ballpiston
