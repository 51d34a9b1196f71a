// A gas between two reservoirs: the heat current, the temperatures along it, and the conductivity.
//
// A trajectory starts from a local equilibrium in which T^(3/2) falls linearly, as in a gas whose
// conductivity grows as sqrt T. It warms up for some of the longest relaxation times, which grow as
// N^2, and is then measured (steady_gas.h). A gas runs at mean temperature 1, and its results are
// scaled.
//
// Beside a cold reservoir a billiard warms up longer. Its start has too few slow bodies that block
// an exchange, and these relax later than the energy. In one cell at cold/hot = 0.01 the rate of
// exchanges and the temperatures deviate from the steady state by 0.5 of the errors of 128
// trajectories after one relaxation time, by 0.16 after two, and by less than 0.05 after four. The
// jump process has no slow bodies.
//
//   conductivity = J N sqrt(T)/[(2/3)(hot^(3/2) - cold^(3/2))],  T = (hot + cold)/2
//
// This is the conductivity at T of N cells in a row, if the conductivity grows as sqrt T.
// The charge Q_t is the energy that passes through the gas along x in a time t, the mean over the
// sections between balls and pistons. Its cumulants c_n grow as t. At a finite t their ratio to t
// differs by an amount in proportion to 1/t, so the estimates are [c_n(2 t) - c_n(t)]/t, with t =
// kChargeWindow. In the billiard slow pistons make the variance grow as t ln t.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "core/arithmetic/number_text.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/expected_limit_error.h"
#include "core/experiment/gas_experiment.h"
#include "core/experiment/steady_gas.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/statistics/cumulants.h"

namespace ballpiston {
namespace {

// In halves of the longest relaxation time; powers of two.
constexpr uint64_t kWarmUp = 2;
constexpr size_t kChargeWindow = 8;

// The states of all groups are one value of the store, which has at most 10^9 bytes.
constexpr double kMostBytesOfStates = 0.9e9;

// At most 128 trajectories, so that a quick question ends quickly. A large gas has fewer, because
// each has to warm up.
constexpr uint64_t kMostTrajectories = 128;

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

// The ratio of the warm-up beside a cold reservoir to the warm-up beside a warm one.
double WarmUpOfTheCold(Model model, double cold) {
  constexpr double kWarm = 0.5, kMost = 8;
  return model == Model::kMarkov ? 1 : std::clamp(kWarm / cold, 1.0, kMost);
}

// The number of relaxation times that a large gas warms up. The start is almost stationary: after
// one relaxation time the mean temperatures deviate by up to 0.3 %. If all trajectories together
// have many balls (`balls`), their statistical error is as small. With kFewBalls the deviation is a
// third of the error.
double WarmUpOfTheMany(double balls) {
  constexpr double kFewBalls = 3600;
  return 1 + std::ceil(std::log(std::max(balls / kFewBalls, 1.0)) / 2);
}

// How the time of a point is divided.
struct SteadyTimes {
  Trajectories trajectories = {};
  uint64_t stretches = 1;  // of half a relaxation time; a power of two
  double stretch = 0;      // at mean temperature 1
};

// The bytes of the state of a billiard's trajectory. A state of the jump process has fewer.
double StateBytes(const GasGeometry& geometry) {
  return 8 *
         (4 * static_cast<double>(geometry.balls()) + 2 * static_cast<double>(geometry.pistons()));
}

// A stretch is half a relaxation time, or a part of it if the stretches of a group would take more
// than about a minute.
SteadyTimes TimesOfConduction(Model model, const GasGeometry& geometry, double cold) {
  const double longest_in_events = model == Model::kBilliardReference ? 0x1p29 : 0x1p33;
  constexpr uint64_t kMostStretches = uint64_t{1} << 40;  // more take longer than any machine lasts
  SteadyTimes times = {.stretch = RelaxationTime(model, geometry, cold) / 2};
  Trajectories& trajectories = times.trajectories;
  const double bytes = static_cast<double>(trajectories.groups) * StateBytes(geometry);
  if (model != Model::kMarkov && bytes > kMostBytesOfStates) trajectories.groups /= 2;
  trajectories.each = std::bit_floor(
      std::clamp<uint64_t>(kMostTrajectories / static_cast<uint64_t>(geometry.balls()), 1,
                           kMostTrajectories / trajectories.groups));
  const double events = static_cast<double>(trajectories.each) *
                        WorkOfReplica(model, geometry, times.stretch).Events();
  while (times.stretches < kMostStretches &&
         events > longest_in_events * static_cast<double>(times.stretches)) {
    times.stretches *= 2;
  }
  times.stretch /= static_cast<double>(times.stretches);
  const double balls =
      static_cast<double>(trajectories.count()) * static_cast<double>(geometry.balls());
  const double factor = std::max(WarmUpOfTheCold(model, cold), WarmUpOfTheMany(balls));
  const auto relaxation_times = static_cast<uint64_t>(std::ceil(factor));
  // Rounded up to a power of two: beside a cold reservoir a shorter warm-up leaves a deviation as
  // large as the error of many balls.
  trajectories.warm_up = kWarmUp * std::bit_ceil(relaxation_times) * times.stretches;
  return times;
}

// The places of the temperature profile, from the hot end. In a row the bodies alternate: body k,
// at x = k/2, is the piston at an edge if k is even, else the ball in the column after that edge.
// In a long gas several neighbours share a place.
class ProfilePlaces {
 public:
  explicit ProfilePlaces(const GasGeometry& geometry)
      : rows_(geometry.shape().rows), bodies_(2 * geometry.shape().columns + 1) {}

  size_t size() const { return static_cast<size_t>(std::min(bodies_, kMostPlaces)); }
  double Position(size_t place) const {
    return static_cast<double>(First(place) + First(place + 1) - 1) / 4;
  }

  // The mean temperature at each place.
  std::vector<double> Temperatures(const GasMeter& meter) const {
    std::vector<double> temperatures(size());
    for (int64_t row = 0; row < rows_; ++row) {
      for (size_t place = 0; place < size(); ++place) {
        for (int64_t k = First(place); k < First(place + 1); ++k) {
          temperatures[place] += TemperatureOf(row, k, meter);
        }
      }
    }
    for (size_t place = 0; place < size(); ++place) {
      temperatures[place] /= static_cast<double>(rows_ * (First(place + 1) - First(place)));
    }
    return temperatures;
  }

 private:
  static constexpr int64_t kMostPlaces = 257;  // enough for the bodies of 128 columns

  // The first body of a row at this place.
  int64_t First(size_t place) const {
    return static_cast<int64_t>(place) * bodies_ / static_cast<int64_t>(size());
  }

  double TemperatureOf(int64_t row, int64_t k, const GasMeter& meter) const {
    const int64_t columns = bodies_ / 2;
    if (k % 2 == 1) return meter.MeanEnergy(static_cast<size_t>(row * columns + k / 2));
    const int64_t piston = row * (columns + 1) + k / 2;
    return 2 * meter.MeanEnergy(meter.balls() + static_cast<size_t>(piston));
  }

  int64_t rows_;
  int64_t bodies_;  // of a row
};

SteadyTimes TimesAt(Model model, const PointParameters& point) {
  return TimesOfConduction(model, OpenGasOf(point), point[kCold] / MeanTemperature(point));
}

class GasConduction : public SteadyGas {
 public:
  GasConduction(const EnsembleSpec& spec, const PointParameters& point)
      : SteadyGas(spec, point, TimesAt(spec.model, point).stretch,
                  kPlaces + ProfilePlaces(OpenGasOf(point)).size()),
        of_half_(static_cast<size_t>(std::countr_zero(TimesAt(spec.model, point).stretches))),
        places_(geometry()) {
    SetMeasurements({.groups = std::vector<GroupState>(trajectories().groups)}, {HeatCurrent()});
  }

  std::vector<double> IntegralsOf(const GasMeter& meter) const override {
    std::vector<double> integrals(kPlaces + places_.size());
    integrals[kCarried] = meter.carried();
    integrals[kExchanges] = static_cast<double>(meter.exchanges());
    for (size_t i = 0; i < meter.bodies(); ++i) {
      const bool is_ball = i < meter.balls();
      integrals[is_ball ? kBalls : kPistons] += meter.MeanEnergy(i) * meter.duration();
    }
    const std::vector<double> temperatures = places_.Temperatures(meter);
    for (size_t i = 0; i < temperatures.size(); ++i) {
      integrals[kPlaces + i] = temperatures[i] * meter.duration();
    }
    return integrals;
  }

 protected:
  void AddDetails(const BlockResult& merged, PointSummary& summary) const override {
    const std::vector<SteadyGroup> groups = GroupsOf(merged);
    summary.samples = StretchesOf(groups);
    if (groups.empty()) {
      summary.estimates.clear();
      summary.remarks = {RemarkOnUnmeasured(groups)};
      return;
    }
    AddEstimates(groups, summary.estimates);
    summary.curves.push_back(Profile(groups));
    for (const Order& order : StatedOrders()) {
      summary.curves.push_back(CumulantsByWindow(order, groups));
    }
    std::erase_if(summary.curves, [](const Curve& curve) { return curve.points.empty(); });
    summary.remarks = {RemarkOnUnmeasured(groups), RemarkOnWarmUp(groups), RemarkOnErrors(groups),
                       RemarkOnOrders()};
    std::erase(summary.remarks, "");
  }

 private:
  // Indices of the integrals: the energy carried through the contacts along x; the number of
  // exchanges; the energies of the balls and of the pistons; then the temperature at each place.
  static constexpr size_t kCarried = 0, kExchanges = 1, kBalls = 2, kPistons = 3, kPlaces = 4;

  // An error of a cumulant needs this many windows of each group: of two relaxation times, if its
  // own windows are shorter, because the charge of a short window has heavier tails. Then intervals
  // of 95 % cover 93 to 96 % in one cell of the jump process, whose tails are the heaviest. With a
  // quarter of the windows those of the third and the fourth cover 89 to 94 %.
  struct Order {
    int number;
    uint64_t windows;
  };
  static constexpr Order kOrders[] = {{2, 64}, {3, 1024}, {4, 4096}};

  Measurement HeatCurrent() const {
    return {.name = "heat_current",
            .reading = [this](const BlockResult& merged) { return Current(GroupsOf(merged)); },
            .scale = temperature() * std::sqrt(temperature()),
            .exact = HasFall() ? std::nullopt : std::optional(0.0)};
  }

  // The estimates after the heat current. They are not rows of the table, where each would read all
  // groups again.
  void AddEstimates(const std::vector<SteadyGroup>& groups,
                    std::vector<Estimate>& estimates) const {
    const auto add = [&](std::string name, const std::optional<Estimate>& estimate, double scale,
                         std::optional<double> exact = std::nullopt) {
      if (!estimate) return;
      estimates.push_back(Scaled(*estimate, scale));
      estimates.back().name = std::move(name);
      estimates.back().exact = exact;
    };
    const auto exact = HasFall() ? std::nullopt : std::optional(temperature());
    if (HasFall()) {
      const double of_static = InfiniteGasExchangeRate(geometry(), temperature()) / 2;
      add("conductivity", Current(groups), Conductance());
      add("conductivity_ratio", Current(groups), Conductance() / of_static);
    }
    const auto balls = static_cast<double>(geometry().balls());
    const auto pistons = static_cast<double>(geometry().pistons());
    const auto contacts = static_cast<double>(geometry().contacts());
    add("exchange_rate", TimeAverage(kExchanges, contacts, groups), std::sqrt(temperature()));
    add("temperature_ball", TimeAverage(kBalls, balls, groups), temperature(), exact);
    add("temperature_piston", TimeAverage(kPistons, pistons / 2, groups), temperature(), exact);
    for (const Order& order : StatedOrders()) {
      add(NameOf(order), CumulantRate(order, groups), ScaleOf(order));
    }
    add("autocorrelation_time", AutocorrelationTime(groups), 1 / std::sqrt(temperature()));
  }

  // Each ball has one contact on its left and one on its right.
  Estimate Current(const std::vector<SteadyGroup>& groups) const {
    return TimeAverage(kCarried, 2 * static_cast<double>(geometry().balls()), groups);
  }

  bool HasFall() const { return hot() > cold(); }
  double Columns() const { return static_cast<double>(geometry().shape().columns); }
  double Rows() const { return static_cast<double>(geometry().shape().rows); }

  // The conductivity over the current at mean temperature 1. The fall, 2/3 of the difference of the
  // temperatures' powers 3/2, keeps its digits when they are nearly equal.
  double Conductance() const {
    const double difference = (parameters()[kHot] - parameters()[kCold]) / temperature();
    const double fall = 2.0 / 3 * difference * (hot() + std::sqrt(hot() * cold()) + cold()) /
                        (std::sqrt(hot()) + std::sqrt(cold()));
    return Columns() * std::sqrt(temperature()) / fall;
  }

  Curve Profile(const std::vector<SteadyGroup>& groups) const {
    Curve curve = {.name = "temperature_profile", .axis = CurveAxis::kPosition};
    for (size_t i = 0; i < places_.size(); ++i) {
      const Estimate there = Scaled(TimeAverage(kPlaces + i, 1, groups), temperature());
      curve.points.push_back(CurvePointOf(places_.Position(i), there));
    }
    return curve;
  }

  // ---- fluctuations of the charge ----

  static std::string NameOf(const Order& order) {
    return absl::StrCat("charge_cumulant_", order.number);
  }
  // The unit of c_n/t, for one row of the gas.
  double ScaleOf(const Order& order) const {
    return std::pow(temperature(), order.number + 0.5) / Rows();
  }
  // The orders whose unit is within the range of double precision, with room for the values. At a
  // temperature of 1e-120 or 1e120 that is the second alone.
  std::span<const Order> StatedOrders() const {
    constexpr double kLargest = 1e301;
    const auto first = std::ranges::find_if(kOrders, [this](const Order& order) {
      return std::fabs((order.number + 0.5) * std::log(temperature())) > std::log(kLargest);
    });
    return {std::begin(kOrders), first};
  }
  std::string RemarkOnOrders() const {
    const size_t stated = StatedOrders().size();
    if (stated == std::size(kOrders)) return "";
    return absl::StrFormat(
        "%s and above are not stated: in units of this temperature, %.3g, they "
        "are outside the range of double precision",
        NameOf(kOrders[stated]), temperature());
  }

  double WindowTime(size_t length) const {
    return stretch() * static_cast<double>(uint64_t{1} << length);
  }
  // The first window of the estimates.
  size_t EstimatedWindow() const {
    return of_half_ + static_cast<size_t>(std::countr_zero(kChargeWindow));
  }

  // Whether every group has enough windows of this length for an error.
  bool HasWindows(size_t length, uint64_t windows, const std::vector<SteadyGroup>& groups) const {
    length = std::max(length, of_half_ + 2);
    return groups.size() == trajectories().groups && length < kWindowLengths &&
           std::ranges::all_of(groups, [&](const SteadyGroup& group) {
             return group.windows[length].count >= windows;
           });
  }

  // A function of the windows' moments, by their lengths, from all groups.
  template <typename Function>
  static Estimate FromWindows(const std::vector<SteadyGroup>& groups, const Function& function) {
    const Jackknifed found = Jackknife(groups.size(), [&](size_t without) {
      std::array<Moments, kWindowLengths> windows;
      for (size_t i = 0; i < groups.size(); ++i) {
        if (i == without) continue;
        for (size_t j = 0; j < kWindowLengths; ++j) windows[j].Merge(groups[i].windows[j]);
      }
      return function(windows);
    });
    return {.value = found.value, .standard_error = found.error, .batches = groups.size()};
  }

  template <typename Windows>
  double RateOf(int order, const Windows& windows) const {
    const size_t first = EstimatedWindow();
    return (Cumulant(windows[first + 1], order) - Cumulant(windows[first], order)) /
           WindowTime(first);
  }

  std::optional<Estimate> CumulantRate(const Order& order,
                                       const std::vector<SteadyGroup>& groups) const {
    if (!HasWindows(EstimatedWindow() + 1, order.windows, groups)) return std::nullopt;
    return FromWindows(groups, [&](const auto& windows) { return RateOf(order.number, windows); });
  }

  // The integral time of the current's averages over half a relaxation time. It is half of that
  // time if the averages are independent.
  std::optional<Estimate> AutocorrelationTime(const std::vector<SteadyGroup>& groups) const {
    if (!HasWindows(EstimatedWindow() + 1, kOrders[0].windows, groups)) return std::nullopt;
    const double half = WindowTime(of_half_);
    return FromWindows(groups, [&](const auto& windows) {
      return half / 2 * RateOf(2, windows) * half / Cumulant(windows[of_half_], 2);
    });
  }

  // c_n(t)/t by t.
  Curve CumulantsByWindow(const Order& order, const std::vector<SteadyGroup>& groups) const {
    Curve curve = {.name = NameOf(order) + "_by_window"};
    for (size_t length = 0; HasWindows(length, order.windows, groups); ++length) {
      const double time = WindowTime(length);
      const Estimate rate = FromWindows(groups, [&](const auto& windows) {
        return Cumulant(windows[length], order.number) / time;
      });
      curve.points.push_back(
          CurvePointOf(time / std::sqrt(temperature()), Scaled(rate, ScaleOf(order))));
    }
    return curve;
  }

  // Compares the current's error with that of batch means within the trajectories, whose batches
  // are the longest windows of which a trajectory has at least eight.
  std::string RemarkOnErrors(const std::vector<SteadyGroup>& groups) const {
    constexpr double kFewestBatches = 8, kDeviations = 3;
    if (groups.size() < trajectories().groups) return "";
    double stretches = std::numeric_limits<double>::infinity(), all = 0;
    Moments batches;
    for (const SteadyGroup& group : groups) {
      stretches = std::min(stretches, group.measured);
      all += group.measured * static_cast<double>(trajectories().each);
    }
    if (stretches < kFewestBatches) return "";
    const size_t length = std::min<size_t>(
        static_cast<size_t>(std::log2(stretches / kFewestBatches)), kWindowLengths - 1);
    if (length <= of_half_) return "";  // shorter than a relaxation time
    for (const SteadyGroup& group : groups) batches.Merge(group.windows[length]);
    const double within =
        Cumulant(batches, 2) / (WindowTime(length) * all * stretch() * Rows() * Rows());
    const double ratio = std::pow(*Current(groups).standard_error, 2) / within;
    const double freedom = static_cast<double>(trajectories().count() - 1);
    if (ratio <= 1 + kDeviations * std::sqrt(2 / freedom)) return "";
    return absl::StrFormat(
        "the stated error of the heat current is that between independent trajectories; it is "
        "%.2g times that of windows of %.2g within them, because the current has slow correlations",
        std::sqrt(ratio), WindowTime(length) / std::sqrt(temperature()));
  }

  size_t of_half_;  // the length of windows of half a relaxation time
  ProfilePlaces places_;
};

void CheckConductionGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  CheckGasGrid(spec, found);
  const std::vector<double>& hot = spec.grid[kHot];
  for (size_t i = 0; i < hot.size(); ++i) {
    const double largest_cold = std::ranges::max(spec.grid.Beside(kHot, i, kCold));
    if (hot[i] >= largest_cold) continue;
    found.push_back({absl::StrFormat("grid.hot[%d]", i),
                     absl::StrFormat("hot is %s, below cold = %s; permitted: hot >= cold",
                                     NumberText(hot[i]), NumberText(largest_cold))});
  }
}

// The memory includes three copies of the states of all groups: merged, arriving and being written.
Forecast ForecastOfGasConduction(Model model, const PointParameters& point) {
  constexpr double kCopies = 3;
  const GasGeometry geometry = OpenGasOf(point);
  const SteadyTimes times = TimesAt(model, point);
  SampleWork work = WorkOfReplica(model, geometry, times.stretch);
  work.together = static_cast<double>(times.trajectories.each);
  const auto contacts = static_cast<double>(geometry.contacts());
  const auto trajectories = static_cast<double>(times.trajectories.count());
  return {.work = work,
          .collisions = contacts * InfiniteGasExchangeRate(geometry, 1) * times.stretch,
          .memory = MemoryOfReplicas(model, point) + kCopies * trajectories * StateBytes(geometry),
          .trajectories = times.trajectories};
}

// The root of the current's variance in local equilibrium, 2 kappa T^2/(N t), over the current.
// kappa T^2 grows as T^(5/2); Simpson's rule gives its mean over the gas. The last pistons pass the
// current in portions, one for each crossing: their number scatters, and their energy as much. Slow
// pistons determine the error. Measured errors are up to 30 % larger than this; the factor is the
// middle of the range.
Scatter ScatterOfTheCurrent(Model model, const PointParameters& point) {
  const GasGeometry geometry = OpenGasOf(point);
  const double temperature = MeanTemperature(point);
  const double hot = point[kHot] / temperature, cold = point[kCold] / temperature;
  const double fall = hot - cold;
  if (fall == 0) return {std::numeric_limits<double>::infinity()};
  const double mean_power = (std::pow(hot, 2.5) + 4 + std::pow(cold, 2.5)) / 6;
  const double time = TimesAt(model, point).stretch;
  const double conductivity = InfiniteGasExchangeRate(geometry, 1) / 2;
  const auto columns = static_cast<double>(geometry.shape().columns);
  const auto rows = static_cast<double>(geometry.shape().rows);
  const double of_the_gas = 2 * mean_power * columns / (conductivity * time * rows * fall * fall);
  const double of_the_portions = 2 * CrossingTime(model, geometry, cold) / (time * rows);
  constexpr double kMeasuredOverTheory = 1.15;
  return {kMeasuredOverTheory * std::sqrt(of_the_gas + of_the_portions)};
}

std::optional<double> LimitErrorOfConduction(const PointParameters& point) {
  return ExpectedLimitErrorOfConduction(point);
}

constexpr Model kModelsOfGasConduction[] = {Model::kMarkov, Model::kBilliard,
                                            Model::kBilliardReference};
constexpr ParameterUse kParametersOfGasConduction[] = {
    {&kRho}, {&kDelta}, {&kCells}, {&kHot}, {&kCold}};

// At given temperatures they are the current in other units.
constexpr absl::string_view kMultiplesOfTheCurrent[] = {"conductivity", "conductivity_ratio"};

constexpr absl::string_view kNoCurrent =
    "the heat current is 0 if hot = cold; permitted: hot > cold, or samples, collisions or a "
    "budget";

constexpr AimedEstimate kAimsOfGasConduction[] = {{.name = "heat_current",
                                                   .models = kModelsOfGasConduction,
                                                   .scatter = ScatterOfTheCurrent,
                                                   .limit_error = LimitErrorOfConduction,
                                                   .no_error = kNoCurrent,
                                                   .multiples = kMultiplesOfTheCurrent}};

}  // namespace

constinit const ExperimentKind kGasConduction = {.name = "gas-conduction",
                                                 .number = 7,
                                                 .parameters = kParametersOfGasConduction,
                                                 .aims = kAimsOfGasConduction,
                                                 .create = CreateAs<GasConduction>,
                                                 .check_grid = CheckConductionGrid,
                                                 .forecast = ForecastOfGasConduction};

}  // namespace ballpiston
