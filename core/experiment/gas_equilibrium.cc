// A periodic gas in equilibrium: how often a ball and a piston exchange energy, the temperatures of
// balls and pistons, and the laws of their speeds.
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
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/ensemble/computed_answer.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/exact_estimate.h"
#include "core/experiment/gas_experiment.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/statistics/kl_divergence.h"
#include "core/statistics/told_error.h"

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

class GasEquilibrium : public GasExperiment {
 public:
  GasEquilibrium(const EnsembleSpec& spec, const PointParameters& point,
                 const GasGeometry& geometry)
      : GasExperiment(spec, point, geometry, TimesInEquilibrium(geometry)),
        temperature_(point[kTemperature]) {}

  GasState Draw(CounterRandom& random) const override {
    return DrawGas(geometry(), TemperatureProfile(1), random);
  }

  void Measure(const GasMeter& meter, BlockResult& result) const override {
    const auto contacts = static_cast<double>(geometry().contacts());
    result.batch_means[0].Add(static_cast<double>(meter.exchanges()), contacts * meter.duration());
    double balls = 0, pistons = 0;
    for (size_t i = 0; i < meter.bodies(); ++i) {
      const bool is_ball = i < meter.balls();
      (is_ball ? balls : pistons) += meter.MeanEnergy(i);
      result.histograms[is_ball ? 0 : 1].Add(std::sqrt(2 * meter.Energy(i)));
    }
    result.batch_means[1].Add(balls, static_cast<double>(geometry().balls()));
    result.batch_means[2].Add(2 * pistons, static_cast<double>(geometry().pistons()));
  }

  BlockResult EmptyResult() const override { return NoGasesMeasured(); }

  Estimate FirstEstimate(const BlockResult& merged) const override {
    return Mean("exchange_rate", merged, 0, std::sqrt(temperature_),
                GasExchangeRate(geometry(), temperature_));
  }

  PointSummary Summarize(const BlockResult& merged) const override {
    PointSummary summary = {.samples = merged.samples, .health = merged.health};
    summary.estimates = {FirstEstimate(merged),
                         Mean("temperature_ball", merged, 1, temperature_, temperature_),
                         Mean("temperature_piston", merged, 2, temperature_, temperature_)};
    const auto laws = SpeedLaws();
    constexpr std::array<const char*, 2> kBodies = {"ball", "piston"};
    for (size_t i = 0; i < laws.size(); ++i) {
      const KlDivergence divergence = RelativeEntropy(merged.histograms[i].counts, laws[i]);
      summary.estimates.push_back({.name = absl::StrCat(kBodies[i], "_speed_divergence"),
                                   .value = divergence.value,
                                   .standard_error = divergence.standard_error,
                                   .noise_floor = divergence.noise_floor});
      summary.histograms.push_back(
          {.name = absl::StrCat(kBodies[i], "_speed"), .histogram = merged.histograms[i]});
    }
    return summary;
  }

 private:
  Estimate Mean(const char* name, const BlockResult& merged, size_t index, double scale,
                double exact) const {
    const BatchMeans& measured = merged.batch_means[index];
    std::optional<double> error =
        ToldError(static_cast<double>(merged.samples), measured.StandardError());
    if (error) *error *= scale;
    return {.name = name,
            .value = scale * measured.Ratio().value_or(0),
            .standard_error = error,
            .exact = exact};
  }

  double temperature_;
};

GasGeometry PeriodicGasOf(const PointParameters& point) {
  return GasGeometryOf(point, GasEnds::kPeriodic);
}

std::unique_ptr<PointExperiment> CreateGasEquilibrium(const EnsembleSpec& spec,
                                                      const PointParameters& point) {
  const GasGeometry geometry = PeriodicGasOf(point);
  if (spec.model != Model::kClosedForm) {
    return std::make_unique<GasEquilibrium>(spec, point, geometry);
  }
  const double temperature = point[kTemperature];
  PointSummary summary;
  summary.estimates = {ExactEstimate("exchange_rate", GasExchangeRate(geometry, temperature),
                                     kGasExchangeRateRelativeError),
                       ExactEstimate("temperature_ball", temperature, 0),
                       ExactEstimate("temperature_piston", temperature, 0)};
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

std::vector<std::vector<double>> SpeedProbabilitiesAt(const PointParameters&) {
  const auto laws = SpeedLaws();
  return {laws.begin(), laws.end()};
}

constexpr ParameterUse kParametersOfGasEquilibrium[] = {
    {&kRho}, {&kDelta}, {&kCells}, {&kTemperature}};
constexpr Model kModelsOfGasEquilibrium[] = {Model::kClosedForm, Model::kMarkov, Model::kBilliard,
                                             Model::kBilliardReference};

}  // namespace

constinit const ExperimentKind kGasEquilibrium = {.name = "gas-equilibrium",
                                                  .number = 6,
                                                  .parameters = kParametersOfGasEquilibrium,
                                                  .unit = TargetUnit::kEither,
                                                  .models = kModelsOfGasEquilibrium,
                                                  .create = CreateGasEquilibrium,
                                                  .check_grid = CheckGasGrid,
                                                  .work = WorkOfGasEquilibrium,
                                                  .collisions = ExchangesOfASample,
                                                  .error = ErrorOfGasEquilibrium,
                                                  .expected_probabilities = SpeedProbabilitiesAt};

}  // namespace ballpiston
