// A gas between two reservoirs: the heat current, the temperatures along it, and the conductivity.
//
// Each replica starts from a local equilibrium in which T^(3/2) falls linearly, as in a gas whose
// conductivity grows as sqrt T. The replica relaxes for some of the longest relaxation times, which
// grow as N^2, and is then measured for some more. Replicas are independent, so their scatter gives
// the errors. A replica runs at mean temperature 1, and its results are scaled.
//
//   conductivity = J N sqrt(T)/[(2/3)(hot^(3/2) - cold^(3/2))],  T = (hot + cold)/2
//
// This is the conductivity at T of N cells in a row, if the conductivity grows as sqrt T.
// Each replica is a batch of the batch means. The moments are of the mean temperature at each place
// of the profile.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "core/arithmetic/number_text.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/expected_limit_error.h"
#include "core/experiment/gas_experiment.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"

namespace ballpiston {
namespace {

// In the longest relaxation times.
constexpr double kRelaxTimes = 4;
constexpr double kMeasureTimes = 12;

// A replica with more work than this, some minutes, is shortened. It is then not stationary.
double MostEvents(Model model) { return model == Model::kBilliardReference ? 0x1p33 : 0x1p37; }

constexpr int64_t kMostColumnsApart =
    128;  // of the profile; in a longer gas, columns share a place

double MeanTemperature(const PointParameters& point) { return (point[kHot] + point[kCold]) / 2; }

// A piston from a reservoir crosses its stroke in this time, the mean over its speed v, whose
// density is v exp(-v^2/(2 T))/T. The jump process has no strokes.
double CrossingTime(Model model, const GasGeometry& geometry, double temperature) {
  if (model == Model::kMarkov) return 0;
  return geometry.pair().stroke() * std::sqrt(std::numbers::pi / 2 / temperature);
}

// Of the gas, the slowest rate is pi^2 D/N^2, with the diffusivity D = conductivity/heat capacity.
// The conductivity is half of the exchange rate; the heat capacity per cell is 3/2 in a chain and 2
// in a lattice. D is smallest at the cold end, whose value is used. A reservoir colder than a tenth
// of the mean temperature counts as a tenth: only the last 1 % of the gas is colder than that,
// because T^(3/2) is linear. But its last piston is as slow as the reservoir, and the current
// passes through it.
double RelaxationTime(Model model, const GasGeometry& geometry, double cold) {
  constexpr double kColdest = 0.1;
  const double length = static_cast<double>(geometry.shape().columns) + 1;
  const double capacity = geometry.shape().is_lattice ? 2 : 1.5;
  const double rate = InfiniteGasExchangeRate(geometry, std::max(cold, kColdest));
  const double of_the_gas =
      2 * capacity * length * length / (std::numbers::pi * std::numbers::pi * rate);
  return std::max(of_the_gas, CrossingTime(model, geometry, cold));
}

GasTimes TimesOfConduction(Model model, const GasGeometry& geometry, double cold) {
  const double time = RelaxationTime(model, geometry, cold);
  const double events =
      WorkOfReplica(model, geometry, (kRelaxTimes + kMeasureTimes) * time).Events();
  const double share = std::min(MostEvents(model) / events, 1.0);
  return {
      .relax = share * kRelaxTimes * time, .measure = share * kMeasureTimes * time, .share = share};
}

// The places of the temperature profile: a place has the bodies of about the same x. Balls are at
// the middles of cells, pistons between cells. In a long gas several columns share a place, and of
// the pistons only the outermost ones have a place. Places are numbered from the hot end.
class ProfilePlaces {
 public:
  explicit ProfilePlaces(const GasGeometry& geometry)
      : columns_(geometry.shape().columns),
        rows_(geometry.shape().rows),
        each_((columns_ + kMostColumnsApart - 1) / kMostColumnsApart) {
    for (int64_t edge = 0; edge <= columns_; ++edge) {
      if (!HasPlace(edge)) continue;
      At(OfEdge(edge)) = {.position = static_cast<double>(edge), .first = edge, .end = edge + 1};
    }
    for (int64_t first = 0; first < columns_; first += each_) {
      const int64_t end = std::min(first + each_, columns_);
      At(OfColumn(first)) = {.position = static_cast<double>(first + end) / 2,
                             .has_balls = true,
                             .first = first,
                             .end = end};
    }
  }

  size_t size() const { return places_.size(); }
  double Position(size_t place) const { return places_[place].position; }

  // The mean temperature at a place.
  double Temperature(size_t place, const GasMeter& meter) const {
    const auto& [position, has_balls, first, end] = places_[place];
    const int64_t in_a_row = has_balls ? columns_ : columns_ + 1;
    const int64_t first_body = has_balls ? 0 : rows_ * columns_;
    double sum = 0;
    for (int64_t row = 0; row < rows_; ++row) {
      for (int64_t i = first; i < end; ++i) {
        const double energy =
            meter.MeanEnergy(static_cast<size_t>(first_body + row * in_a_row + i));
        sum += has_balls ? energy : 2 * energy;
      }
    }
    return sum / static_cast<double>(rows_ * (end - first));
  }

 private:
  // Of the balls in the columns from `first` to before `end`, or of the pistons at such edges.
  struct Place {
    double position = 0;
    bool has_balls = false;
    int64_t first = 0;
    int64_t end = 0;
  };

  bool HasPlace(int64_t edge) const { return each_ == 1 || edge == 0 || edge == columns_; }
  // Places alternate between edges and columns, or have the columns between the two outermost
  // edges.
  size_t OfEdge(int64_t edge) const {
    if (each_ == 1) return static_cast<size_t>(2 * edge);
    return edge == 0 ? 0 : OfColumn(columns_ - 1) + 1;
  }
  size_t OfColumn(int64_t column) const {
    return static_cast<size_t>(each_ == 1 ? 2 * column + 1 : column / each_ + 1);
  }

  Place& At(size_t place) {
    if (place >= places_.size()) places_.resize(place + 1);
    return places_[place];
  }

  int64_t columns_;
  int64_t rows_;
  int64_t each_;  // columns of a place
  std::vector<Place> places_;
};

GasGeometry OpenGasOf(const PointParameters& point) {
  return GasGeometryOf(point, GasEnds::kReservoirs);
}

GasTimes TimesAt(Model model, const PointParameters& point) {
  return TimesOfConduction(model, OpenGasOf(point), point[kCold] / MeanTemperature(point));
}

class GasConduction : public GasExperiment {
 public:
  GasConduction(const EnsembleSpec& spec, const PointParameters& point)
      : GasExperiment(spec, point, OpenGasOf(point), TimesAt(spec.model, point),
                      MeanTemperature(point)),
        hot_(point[kHot] / temperature()),
        cold_(point[kCold] / temperature()),
        places_(geometry()) {
    SetMeasurements({.moments = std::vector<Moments>(places_.size()),
                     .batch_means = std::vector<BatchMeans>(kMeans + kMeansOfAReplica)},
                    Table());
  }

  TemperatureProfile TemperaturesAtStart() const override { return {hot_, cold_, Columns()}; }

  ThermalWalls WallsOf(const GasRandom& random) const override {
    return {geometry(), hot_, cold_, random};
  }

  size_t MeasuredParts() const override { return 1 + places_.size(); }

  void MeasurePart(size_t part, const GasMeter& meter, BlockResult& result) const override {
    if (part > 0) {
      result.moments[part - 1].Add(places_.Temperature(part - 1, meter));
      return;
    }
    // Each ball has one contact on its left and one on its right.
    const double contacts_along_x = 2 * static_cast<double>(geometry().balls());
    result.batch_means[kCarried].Add(meter.carried(), contacts_along_x * meter.duration());
    AddMeans(meter, kMeans, result);
  }

 protected:
  void AddDetails(const BlockResult& merged, PointSummary& summary) const override {
    summary.curves.push_back(Profile(merged));
    if (times().share == 1) return;
    summary.remarks.push_back(absl::StrFormat(
        "replicas of %.0f cells in a row ran for only %.2g of the time that a stationary state "
        "needs, so there are no standard errors",
        Columns(), times().share));
  }

 private:
  // Indices of the batch means: the energy carried through the contacts along x, over the number of
  // these contacts and the duration; and those of AddMeans.
  static constexpr size_t kCarried = 0, kMeans = 1;

  std::vector<Measurement> Table() const {
    const bool has_fall = hot_ > cold_;
    std::vector<Measurement> table = {{.name = "heat_current",
                                       .reading = Ratio(kCarried),
                                       .scale = temperature() * std::sqrt(temperature()),
                                       .exact = has_fall ? std::nullopt : std::optional(0.0)}};
    if (has_fall) {
      const double of_static = InfiniteGasExchangeRate(geometry(), temperature()) / 2;
      table.push_back({"conductivity", Ratio(kCarried), Conductance()});
      table.push_back({"conductivity_ratio", Ratio(kCarried), Conductance() / of_static});
    }
    for (Measurement& row : MeansFrom(kMeans)) table.push_back(std::move(row));
    return table;
  }

  double Columns() const { return static_cast<double>(geometry().shape().columns); }

  // The conductivity over the current at mean temperature 1.
  double Conductance() const {
    const double fall = 2.0 / 3 * (hot_ * std::sqrt(hot_) - cold_ * std::sqrt(cold_));
    return Columns() * std::sqrt(temperature()) / fall;
  }

  Curve Profile(const BlockResult& merged) const {
    Curve curve = {.name = "temperature_profile", .axis = CurveAxis::kPosition};
    for (size_t i = 0; i < places_.size(); ++i) {
      const Measurement there = {"", Mean(i), temperature()};
      curve.points.push_back(CurvePointOf(places_.Position(i), *there.Of(merged)));
    }
    return curve;
  }

  double hot_;  // this and cold_ in units of the mean temperature
  double cold_;
  ProfilePlaces places_;
};

void CheckConductionGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  CheckGasGrid(spec, found);
  const std::vector<double>&hot = spec.grid[kHot], &cold = spec.grid[kCold];
  double largest_cold = 0;
  for (const double value : cold) largest_cold = std::fmax(largest_cold, value);  // passes by NaN
  for (size_t i = 0; i < hot.size(); ++i) {
    if (!(hot[i] < largest_cold)) continue;
    found.push_back({absl::StrFormat("grid.hot[%d]", i),
                     absl::StrFormat("hot is %s, below cold = %s; permitted: hot >= cold",
                                     NumberText(hot[i]), NumberText(largest_cold))});
  }
}

void CheckConductionTolerance(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  for (const double hot : spec.grid[kHot]) {
    for (const double cold : spec.grid[kCold]) {
      if (hot != cold) continue;
      found.push_back({"target.tolerance",
                       absl::StrFormat("is relative, but the heat current is 0 if hot = cold = %s; "
                                       "permitted in this case: samples, collisions or a budget",
                                       NumberText(hot))});
      return;
    }
  }
}

bool IsCutShort(Model model, PointParameters point, const GasShape& shape) {
  point.Set(kCells, CodeOf(shape));
  return TimesAt(model, point).share < 1;
}

std::string WhyConductionHasNoErrors(Model model, const PointParameters& point) {
  const GasShape shape = ShapeOf(point[kCells]);
  if (!IsCutShort(model, point, shape)) return "";
  // The time that a replica needs grows with its length.
  GasShape longest = shape;
  int64_t short_enough = 0, too_long = shape.columns;
  while (too_long - short_enough > 1) {
    longest.columns = (short_enough + too_long) / 2;
    (IsCutShort(model, point, longest) ? too_long : short_enough) = longest.columns;
  }
  return absl::StrFormat(
      "is %s, whose replicas are cut short and have no errors; permitted with a tolerance at rho = "
      "%s, delta = %s, hot = %s, cold = %s, by model %s: %s",
      Text(shape), NumberText(point[kRho]), NumberText(point[kDelta]), NumberText(point[kHot]),
      NumberText(point[kCold]), Name(model),
      short_enough == 0 ? "none" : absl::StrFormat("up to %d cells in a row", short_enough));
}

SampleWork WorkOfGasConduction(Model model, const PointParameters& point) {
  return WorkOfReplica(model, OpenGasOf(point), TimesAt(model, point).Total());
}

double ExchangesOfAConductionSample(Model model, const PointParameters& point) {
  const GasGeometry geometry = OpenGasOf(point);
  return static_cast<double>(geometry.contacts()) * InfiniteGasExchangeRate(geometry, 1) *
         TimesAt(model, point).measure;
}

// The root of the current's variance in local equilibrium, 2 kappa T^2/(N t), over the current.
// kappa T^2 grows as T^(5/2); Simpson's rule gives its mean over the gas. The last pistons pass the
// current in portions, one for each crossing: their number scatters, and their energy as much. Slow
// pistons determine the error. Measured errors are up to 30 % larger.
double ErrorOfGasConduction(Model model, const PointParameters& point) {
  const GasGeometry geometry = OpenGasOf(point);
  const double temperature = MeanTemperature(point);
  const double hot = point[kHot] / temperature, cold = point[kCold] / temperature;
  const double fall = hot - cold;
  if (fall == 0) return std::numeric_limits<double>::infinity();
  const double mean_power = (std::pow(hot, 2.5) + 4 + std::pow(cold, 2.5)) / 6;
  const double time = TimesAt(model, point).measure;
  const double conductivity = InfiniteGasExchangeRate(geometry, 1) / 2;
  const auto columns = static_cast<double>(geometry.shape().columns);
  const auto rows = static_cast<double>(geometry.shape().rows);
  const double of_the_gas = 2 * mean_power * columns / (conductivity * time * rows * fall * fall);
  const double of_the_portions = 2 * CrossingTime(model, geometry, cold) / (time * rows);
  return std::sqrt(of_the_gas + of_the_portions);
}

constexpr LimitError kLimitErrorOfConduction = {
    .model = Model::kMarkov,
    .is_known = [](const PointParameters&) { return true; },
    .expected = ExpectedLimitErrorOfConduction};

constexpr Model kModelsOfGasConduction[] = {Model::kMarkov, Model::kBilliard,
                                            Model::kBilliardReference};
constexpr ParameterUse kParametersOfGasConduction[] = {
    {&kRho}, {&kDelta}, {&kCells}, {&kHot}, {&kCold}};

// At given temperatures they are the current in other units.
constexpr absl::string_view kMultiplesOfTheCurrent[] = {"conductivity", "conductivity_ratio"};

constexpr AimedEstimate kAimsOfGasConduction[] = {{.name = "heat_current",
                                                   .models = kModelsOfGasConduction,
                                                   .error = ErrorOfGasConduction,
                                                   .limit_error = &kLimitErrorOfConduction,
                                                   .multiples = kMultiplesOfTheCurrent}};

}  // namespace

constinit const ExperimentKind kGasConduction = {.name = "gas-conduction",
                                                 .number = 7,
                                                 .parameters = kParametersOfGasConduction,
                                                 .unit = TargetUnit::kEither,
                                                 .models = kModelsOfGasConduction,
                                                 .aims = kAimsOfGasConduction,
                                                 .create = CreateAs<GasConduction>,
                                                 .check_grid = CheckConductionGrid,
                                                 .check_tolerance = CheckConductionTolerance,
                                                 .no_errors = WhyConductionHasNoErrors,
                                                 .work = WorkOfGasConduction,
                                                 .collisions = ExchangesOfAConductionSample,
                                                 .memory = MemoryOfReplicas};

}  // namespace ballpiston
