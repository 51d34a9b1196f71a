#include "client/output/json.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/parameter.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/temperature.h"
#include "server/convert/spec.h"
#include "tests/core/model_choice/questions.h"
#include "tests/questions/questions.h"
#include "tests/support/dice.h"

namespace ballpiston::questions {
namespace {

class Dice : public ballpiston::Dice {
 public:
  Dice(uint64_t seed, uint64_t number)
      : ballpiston::Dice(seed * 0xbf58476d1ce4e5b9 + number * 0x94d049bb133111eb) {}

  double Between(double lower, double upper) { return lower + (upper - lower) * Uniform(); }
  double LogBetween(double lower, double upper) {
    return std::exp(Between(std::log(lower), std::log(upper)));
  }
  template <typename T>
  T Pick(const std::vector<T>& list) {
    return list[Below(list.size())];
  }
};

// The neighbours of x among the doubles.
inline double Above(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }
inline double Below(double x) {
  return std::nextafter(x, -std::numeric_limits<double>::infinity());
}

// ---- values of parameters ----
//
// All lie in the permitted domain. `extreme` values lie log-uniformly close to an end of the
// domain, or are the end itself or its neighbour among the doubles. The others are those of an
// ordinary question.

// In [lower, upper], often near an end.
double NearAnEnd(Dice& dice, double lower, double upper) {
  const double width = upper - lower, distance = width * std::pow(10, -dice.Between(0, 17));
  const double above = lower + distance, below = std::max(upper - distance, lower);
  const double values[] = {
      lower, upper, std::min(Above(lower), upper), std::max(Below(upper), lower), above, above,
      below, below};
  return values[dice.Below(8)];
}

double Rho(Dice& dice, bool extreme) {
  if (extreme) return NearAnEnd(dice, Above(kMinRho), Below(kMaxRho));
  return dice.Between(0.505, 0.695);
}

double Delta(Dice& dice, double bound, bool extreme) {
  if (!extreme) return bound * dice.LogBetween(0.05, 1);
  constexpr double kLeast = std::numeric_limits<double>::denorm_min();
  if (dice.Chance(0.15)) return std::max(bound * std::pow(10, -dice.Between(0, 324)), kLeast);
  if (dice.Chance(0.15)) return std::min(bound * (1 + kDeltaSlack / 2), Below(0.5));
  if (dice.Chance(0.5)) return bound * std::pow(10, -dice.Between(0, 17));
  return NearAnEnd(dice, kLeast, bound);
}

double Epsilon(Dice& dice, bool extreme) {
  if (!extreme) return dice.Between(0.02, 0.48);
  if (dice.Chance(0.2)) return dice.Pick<double>({0.25, Above(0.25), Below(0.25), 1.0 / 6});
  return NearAnEnd(dice, 0, 0.5);
}

double Exponent(Dice& dice, bool extreme) {
  return extreme ? NearAnEnd(dice, 0, kMaxExponent) : dice.Pick<double>({0, 1, 1, 2, 3.5});
}

std::string Cells(Dice& dice, bool extreme) {
  const auto whole = [&](double upper) {
    return static_cast<int64_t>(dice.LogBetween(1, upper + 0.999));
  };
  if (!extreme && dice.Chance(0.5)) return absl::StrCat(whole(8));
  if (!extreme) return absl::StrCat(whole(4), "x", whole(4));
  if (dice.Chance(0.3)) return dice.Pick<std::string>({"1", "1x1", "1000000", "1000x1000", "2"});
  const int64_t columns = whole(kMaxCells);
  if (dice.Chance(0.4)) return absl::StrCat(columns);
  const int64_t rows = whole(static_cast<double>(kMaxCells / columns));
  return dice.Chance(0.5) ? absl::StrCat(columns, "x", rows) : absl::StrCat(rows, "x", columns);
}

double Temperature(Dice& dice, bool extreme) {
  if (!extreme) return dice.Chance(0.3) ? 1 : dice.LogBetween(0.1, 10);
  if (dice.Chance(0.4)) {
    return dice.Pick<double>(
        {kMinTemperature, kMaxTemperature, Above(kMinTemperature), Below(kMaxTemperature)});
  }
  return dice.LogBetween(2 * kMinTemperature, kMaxTemperature / 2);
}

double Cold(Dice& dice, double hot, bool extreme) {
  if (dice.Chance(0.1)) return hot;
  if (!extreme) return std::max(hot * dice.Between(0.2, 1), kMinTemperature);
  if (dice.Chance(0.1)) return std::max(Below(hot), kMinTemperature);
  const double most = dice.Chance(0.5) ? 12 : 240;  // powers of ten between hot and cold
  return std::max(hot * std::pow(10, -dice.Between(0, most)), kMinTemperature);
}

// ---- questions ----

class Drawing {
 public:
  Drawing(uint64_t seed, uint64_t number, double most_seconds)
      : dice_(seed, number),
        most_seconds_(most_seconds),
        experiment_(*AllExperiments()[dice_.Below(AllExperiments().size())]) {}

  v1::EnsembleSpec Draw() {
    spec_.set_experiment(static_cast<v1::EnsembleSpec::Experiment>(experiment_.number));
    if (dice_.Chance(0.8)) spec_.set_seed(dice_.Bits());
    for (const ParameterUse& use : experiment_.parameters) {
      if (use.needed || dice_.Chance(0.5)) AddList(*use.parameter);
    }
    SetMethod();
    SetTarget();
    return spec_;
  }

 private:
  bool Extreme() { return dice_.Chance(0.35); }
  // The time of a replica of gas-lyapunov grows with the third power of the cells, at most 32.
  bool TakesAnyGas() const { return &experiment_ != &kGasLyapunov; }

  void AddList(const Parameter& parameter) {
    const size_t values = dice_.Chance(0.85) ? 1 : 2 + dice_.Below(2);
    for (size_t i = 0; i < values; ++i) AddValue(parameter, *spec_.mutable_grid());
  }

  // rho comes before delta, and hot before cold.
  void AddValue(const Parameter& parameter, v1::Grid& grid) {
    if (&parameter == &kRho) {
      const double rho = Rho(dice_, Extreme());
      bound_ = std::min(bound_, IsOfAGas(&experiment_) ? GasDeltaBound(rho) : PairDeltaBound(rho));
      return grid.add_rho(rho);
    }
    if (&parameter == &kDelta) return grid.add_delta(Delta(dice_, bound_, Extreme()));
    if (&parameter == &kEpsilon) return grid.add_epsilon(Epsilon(dice_, Extreme()));
    if (&parameter == &kExponent) return grid.add_exponent(Exponent(dice_, Extreme()));
    if (&parameter == &kCells) return grid.add_cells(Cells(dice_, Extreme() && TakesAnyGas()));
    if (&parameter == &kTemperature) return grid.add_temperature(Temperature(dice_, Extreme()));
    if (&parameter == &kHot) return grid.add_hot(Temperature(dice_, Extreme()));
    const double hot = *std::min_element(grid.hot().begin(), grid.hot().end());
    grid.add_cold(Cold(dice_, hot, Extreme()));
  }

  void SetMethod() {
    if (dice_.Chance(0.65)) {
      spec_.set_model(server::ModelMessage(
          dice_.Chance(0.95)
              ? dice_.Pick<Model>({experiment_.models().begin(), experiment_.models().end()})
              : kLadder[dice_.Below(std::size(kLadder))]));
    } else {
      spec_.set_verify(dice_.Chance(0.3));
    }
    if (dice_.Chance(0.12)) spec_.set_precision(v1::EnsembleSpec::SINGLE);
    const bool has_choice = experiment_.aims.size() > 1;
    if (dice_.Chance(has_choice ? 0.5 : 0.1)) {
      const auto& aim = experiment_.aims[dice_.Below(experiment_.aims.size())];
      spec_.mutable_target()->set_estimate(std::string(aim.name));
    }
  }

  void SetTarget() {
    v1::Target& target = *spec_.mutable_target();
    if (dice_.Chance(0.6)) return SetCount(AffordableSamples(), target);
    switch (dice_.Below(8)) {
      case 0:
        return;  // the default, 10,000
      case 1:
        return SetCount(dice_.Pick<double>({1, 2, 63, 64, kMaxSamples - 1.0, 1.0 * kMaxSamples}),
                        target);
      case 2:
        return SetCount(dice_.LogBetween(1, 1.0 * kMaxSamples), target);
      case 3:
      case 4:
        return SetTolerance(AffordableSamples(), target);
      case 5:
        return target.set_tolerance(dice_.Chance(0.5) ? dice_.LogBetween(1e-300, 1)
                                                      : std::nextafter(1.0, 0));
      case 6:
        SetTolerance(AffordableSamples(), target);
        [[fallthrough]];
      default:
        SetBudget(target);
    }
  }

  void SetBudget(v1::Target& target) {
    const double seconds = dice_.Chance(0.8) ? dice_.LogBetween(1e-5, most_seconds_)
                                             : dice_.LogBetween(1e-9, kMaxBudgetSeconds);
    auto& budget = *target.mutable_budget();
    budget.set_seconds(static_cast<int64_t>(seconds));
    budget.set_nanos(
        std::max(static_cast<int32_t>((seconds - std::floor(seconds)) * 1e9), int32_t{1}));
  }

  // Samples or collisions.
  void SetCount(double samples, v1::Target& target) {
    const bool counts_collisions = dice_.Chance(0.4);
    const double each = counts_collisions && IsPermitted() ? CollisionsOfASample() : 1;
    const double most = static_cast<double>(kMaxSamples);
    const double wanted = samples * each;
    const auto count =
        static_cast<int64_t>(wanted >= 1 ? std::min(wanted, most) : 1);  // NaN becomes 1
    counts_collisions ? target.set_collisions(count) : target.set_samples(count);
  }

  void SetTolerance(double samples, v1::Target& target) {
    double error = IsPermitted() ? ScatterOf(Spec(), Point()).error : 1;
    if (!std::isfinite(error)) error = 1;
    target.set_tolerance(std::clamp(error / std::sqrt(samples), 1e-12, 0.9));
  }

  double AffordableSamples() {
    const double seconds = dice_.LogBetween(1e-2, 1) * most_seconds_;
    if (!IsPermitted()) return 64;
    const double samples = SamplesIn(seconds / Spec().grid.PointCount(), Spec(), 0,
                                     Sampled(Spec().model), SomeMachine());
    return samples >= 1 ? std::min(samples, 1e6) : 1;  // NaN becomes 1
  }

  double CollisionsOfASample() { return ForecastOf(Spec(), Point()).collisions; }

  EnsembleSpec Spec() const { return server::CheckSpec(spec_).spec; }
  PointParameters Point() const { return PointAt(Spec(), 0); }
  // So far: the target comes last.
  bool IsPermitted() const { return server::CheckSpec(spec_).violations.empty(); }

  Dice dice_;
  const double most_seconds_;
  const ExperimentKind& experiment_;
  double bound_ = 0.5;
  v1::EnsembleSpec spec_;
};

}  // namespace

std::string Command(const v1::EnsembleSpec& spec) {
  return absl::StrCat("ballpiston run --spec - <<<'", client::Json(spec), "'");
}

v1::EnsembleSpec Draw(uint64_t seed, uint64_t number, double most_seconds) {
  return Drawing(seed, number, most_seconds).Draw();
}

}  // namespace ballpiston::questions
