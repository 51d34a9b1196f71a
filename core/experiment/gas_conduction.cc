// A gas between two reservoirs: the heat current, the temperatures along it, and the conductivity.
//
// Each replica starts from the local equilibrium in which T^(3/2) falls linearly, as it does where
// the conductivity grows as sqrt T, relaxes for some of the longest relaxation times, which grow as
// N^2, and is measured for some more. Replicas are independent, so their scatter gives the errors.
// A replica runs at mean temperature 1: all of the gas scales.
//
//   conductivity = J N sqrt(T)/[(2/3)(hot^(3/2) - cold^(3/2))],  T = (hot + cold)/2
//
// is that at T of N cells in a row whose conductivity grows as sqrt T.
//   batch means, a replica each  [0] energy carried through all contacts along x; these times
//   duration
//                                [1] exchanges, contacts times duration
//                                [2] the balls' mean energies, balls  [3] twice the pistons'
//   moments                      the mean temperature at each place of the profile
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/arithmetic/number_text.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/gas_experiment.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/statistics/told_error.h"

namespace ballpiston {
namespace {

// In the longest relaxation times.
constexpr double kRelaxTimes = 4;
constexpr double kMeasureTimes = 12;

// A replica with more work than this, some minutes in lanes, is cut short before it is stationary.
constexpr double kMostEvents = 0x1p37;

constexpr int64_t kMostColumnsApart = 128;  // of the profile; beyond, neighbours share a place

double MeanTemperature(const PointParameters& point) { return (point[kHot] + point[kCold]) / 2; }

// pi^2 D/N^2 is the slowest rate, with the diffusivity D = conductivity/heat capacity: half of the
// exchange rate over 3/2 for each cell of a chain, 2 of a lattice; slowest at the cold end.
double RelaxationTime(const GasGeometry& geometry, double cold) {
  const double length = static_cast<double>(geometry.shape().columns) + 1;
  const double capacity = geometry.shape().is_lattice ? 2 : 1.5;
  const double rate = InfiniteGasExchangeRate(geometry, cold);
  return 2 * capacity * length * length / (std::numbers::pi * std::numbers::pi * rate);
}

struct ConductionTimes {
  GasTimes times;
  bool is_stationary;
};

ConductionTimes TimesOfConduction(Model model, const GasGeometry& geometry, double cold) {
  // Near equal temperatures half of the mean is far below any mean that matters.
  const double time = RelaxationTime(geometry, std::max(cold, 0.1));
  const double events =
      WorkOfReplica(model, geometry, (kRelaxTimes + kMeasureTimes) * time).Events();
  const double share = std::min(kMostEvents / events, 1.0);
  return {{.relax = share * kRelaxTimes * time, .measure = share * kMeasureTimes * time},
          share == 1};
}

// Bodies of about the same x, whose mean temperature is one point of the profile.
struct Place {
  double position = 0;
  std::vector<size_t> bodies = {};
};

void AddBody(double position, size_t body, std::vector<Place>& places) {
  const auto is_there = [position](const Place& place) { return place.position == position; };
  auto place = std::find_if(places.begin(), places.end(), is_there);
  if (place == places.end()) place = places.insert(places.end(), {position});
  place->bodies.push_back(body);
}

// Balls stand at the middles of cells, pistons between them. Of a long gas, some columns share a
// place, and of the pistons there are the outermost ones alone.
std::vector<Place> PlacesOf(const GasGeometry& geometry) {
  const int64_t columns = geometry.shape().columns;
  const int64_t each = (columns + kMostColumnsApart - 1) / kMostColumnsApart;
  std::vector<Place> places;
  for (int64_t ball = 0; ball < geometry.balls(); ++ball) {
    const int64_t first = ball % columns / each * each, last = std::min(first + each, columns);
    AddBody(static_cast<double>(first + last) / 2, static_cast<size_t>(ball), places);
  }
  for (int64_t piston = 0; piston < geometry.pistons(); ++piston) {
    if (!geometry.IsAlongX(piston)) continue;
    const double position = geometry.PositionOfPiston(piston);
    const bool is_outermost = position == 0 || position == static_cast<double>(columns);
    if (each > 1 && !is_outermost) continue;
    AddBody(position, static_cast<size_t>(geometry.balls() + piston), places);
  }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.position < b.position; });
  return places;
}

class GasConduction : public GasExperiment {
 public:
  GasConduction(const EnsembleSpec& spec, const PointParameters& point, const GasGeometry& geometry,
                const ConductionTimes& times)
      : GasExperiment(spec, point, geometry, times.times),
        temperature_(MeanTemperature(point)),
        hot_(point[kHot] / temperature_),
        cold_(point[kCold] / temperature_),
        is_stationary_(times.is_stationary),
        places_(PlacesOf(geometry)) {}

  GasState Draw(CounterRandom& random) const override {
    return DrawGas(geometry(), TemperatureProfile(hot_, cold_, Columns()), random);
  }

  ThermalWalls WallsOf(const GasRandom& random) const override {
    return {geometry(), hot_, cold_, random};
  }

  void Measure(const GasMeter& meter, BlockResult& result) const override {
    const double crossings = 2 * static_cast<double>(geometry().balls());  // contacts along x
    result.batch_means[0].Add(meter.carried(), crossings * meter.duration());
    result.batch_means[1].Add(static_cast<double>(meter.exchanges()),
                              static_cast<double>(geometry().contacts()) * meter.duration());
    double balls = 0, pistons = 0;
    for (size_t i = 0; i < meter.bodies(); ++i) {
      (i < meter.balls() ? balls : pistons) += meter.MeanEnergy(i);
    }
    result.batch_means[2].Add(balls, static_cast<double>(geometry().balls()));
    result.batch_means[3].Add(2 * pistons, static_cast<double>(geometry().pistons()));
    for (size_t i = 0; i < places_.size(); ++i) {
      result.moments[i].Add(TemperatureAt(places_[i], meter));
    }
  }

  BlockResult EmptyResult() const override {
    BlockResult result;
    result.batch_means.resize(4);
    result.moments.resize(places_.size());
    return result;
  }

  Estimate FirstEstimate(const BlockResult& merged) const override {
    Estimate current = Mean("heat_current", merged, 0, temperature_ * std::sqrt(temperature_));
    if (hot_ == cold_) current.exact = 0;
    return current;
  }

  PointSummary Summarize(const BlockResult& merged) const override {
    PointSummary summary = {.samples = merged.samples, .health = merged.health};
    summary.estimates.push_back(FirstEstimate(merged));
    if (hot_ > cold_) {
      summary.estimates.push_back(Mean("conductivity", merged, 0, Conductance()));
      summary.estimates.push_back(Mean("conductivity_ratio", merged, 0,
                                       Conductance() / StaticConductivityAt(temperature_)));
    }
    summary.estimates.push_back(Mean("exchange_rate", merged, 1, std::sqrt(temperature_)));
    summary.estimates.push_back(Mean("temperature_ball", merged, 2, temperature_));
    summary.estimates.push_back(Mean("temperature_piston", merged, 3, temperature_));
    summary.curves.push_back(Profile(merged));
    if (!is_stationary_) {
      summary.remarks.push_back(absl::StrFormat(
          "replicas of %.0f cells in a row were followed for %.2g of the time that a stationary "
          "state takes: no errors can be given",
          Columns(), TimeShare()));
    }
    return summary;
  }

 private:
  double Columns() const { return static_cast<double>(geometry().shape().columns); }
  double TimeShare() const {
    return times().Total() /
           ((kRelaxTimes + kMeasureTimes) * RelaxationTime(geometry(), std::max(cold_, 0.1)));
  }
  double StaticConductivityAt(double temperature) const {
    return InfiniteGasExchangeRate(geometry(), temperature) / 2;
  }

  // The conductivity over the current at mean temperature 1.
  double Conductance() const {
    const double fall = 2.0 / 3 * (hot_ * std::sqrt(hot_) - cold_ * std::sqrt(cold_));
    return Columns() * std::sqrt(temperature_) / fall;
  }

  double TemperatureAt(const Place& place, const GasMeter& meter) const {
    double sum = 0;
    for (const size_t body : place.bodies) {
      sum += (body < meter.balls() ? 1 : 2) * meter.MeanEnergy(body);
    }
    return sum / static_cast<double>(place.bodies.size());
  }

  std::optional<double> Told(const BlockResult& merged, std::optional<double> error,
                             double scale) const {
    if (!error || !is_stationary_) return std::nullopt;
    return ToldError(static_cast<double>(merged.samples), *error * scale);
  }

  Estimate Mean(const char* name, const BlockResult& merged, size_t index, double scale) const {
    const BatchMeans& measured = merged.batch_means[index];
    return {.name = name,
            .value = scale * measured.Ratio().value_or(0),
            .standard_error = Told(merged, measured.StandardError(), scale)};
  }

  Curve Profile(const BlockResult& merged) const {
    Curve curve = {.name = "temperature_profile", .axis = CurveAxis::kPosition};
    for (size_t i = 0; i < places_.size(); ++i) {
      const Moments& measured = merged.moments[i];
      curve.points.push_back(
          {.at = places_[i].position,
           .value = temperature_ * measured.mean,
           .standard_error = Told(merged, measured.StandardError(), temperature_)});
    }
    return curve;
  }

  double temperature_;  // the mean; all else is in its units
  double hot_;
  double cold_;
  bool is_stationary_;
  std::vector<Place> places_;
};

GasGeometry OpenGasOf(const PointParameters& point) {
  return GasGeometryOf(point, GasEnds::kReservoirs);
}

ConductionTimes TimesAt(Model model, const PointParameters& point) {
  return TimesOfConduction(model, OpenGasOf(point), point[kCold] / MeanTemperature(point));
}

std::unique_ptr<PointExperiment> CreateGasConduction(const EnsembleSpec& spec,
                                                     const PointParameters& point) {
  return std::make_unique<GasConduction>(spec, point, OpenGasOf(point), TimesAt(spec.model, point));
}

void CheckConductionGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  CheckGasGrid(spec, found);
  const std::vector<double>&hot = spec.grid[kHot], &cold = spec.grid[kCold];
  if (cold.empty()) return;
  const double coldest_hot = *std::max_element(cold.begin(), cold.end());
  for (size_t i = 0; i < hot.size(); ++i) {
    if (!(hot[i] < coldest_hot)) continue;
    found.push_back({absl::StrFormat("grid.hot[%d]", i),
                     absl::StrFormat("hot is %s, below cold = %s; permitted: hot >= cold",
                                     NumberText(hot[i]), NumberText(coldest_hot))});
  }
}

void CheckConductionTolerance(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  for (const double hot : spec.grid[kHot]) {
    for (const double cold : spec.grid[kCold]) {
      if (hot != cold) continue;
      found.push_back({"target.tolerance",
                       absl::StrFormat("is relative, and the heat current is 0 where hot = cold = "
                                       "%s; permitted there: samples, collisions or a budget",
                                       NumberText(hot))});
      return;
    }
  }
}

SampleWork WorkOfGasConduction(Model model, const PointParameters& point) {
  return WorkOfReplica(model, OpenGasOf(point), TimesAt(model, point).times.Total());
}

double ExchangesOfAConductionSample(const PointParameters& point) {
  const GasGeometry geometry = OpenGasOf(point);
  return static_cast<double>(geometry.contacts()) * InfiniteGasExchangeRate(geometry, 1) *
         TimesAt(Model::kBilliard, point).times.measure;
}

// The current's fluctuations in equilibrium, 2 kappa T^2/(N t), over the current itself.
double ErrorOfGasConduction(const PointParameters& point) {
  const GasGeometry geometry = OpenGasOf(point);
  const double temperature = MeanTemperature(point);
  const double fall = (point[kHot] - point[kCold]) / temperature;
  const double time = TimesAt(Model::kBilliard, point).times.measure;
  const double conductivity = InfiniteGasExchangeRate(geometry, 1) / 2;
  const auto columns = static_cast<double>(geometry.shape().columns);
  const auto rows = static_cast<double>(geometry.shape().rows);
  return std::sqrt(2 * columns / (conductivity * time * rows)) / fall;
}

constexpr ParameterUse kParametersOfGasConduction[] = {
    {&kRho}, {&kDelta}, {&kCells}, {&kHot}, {&kCold}};

}  // namespace

constinit const ExperimentKind kGasConduction = {.name = "gas-conduction",
                                                 .number = 7,
                                                 .parameters = kParametersOfGasConduction,
                                                 .unit = TargetUnit::kEither,
                                                 .models = kModelsOfGases,
                                                 .create = CreateGasConduction,
                                                 .check_grid = CheckConductionGrid,
                                                 .check_tolerance = CheckConductionTolerance,
                                                 .work = WorkOfGasConduction,
                                                 .collisions = ExchangesOfAConductionSample,
                                                 .error = ErrorOfGasConduction};

}  // namespace ballpiston
