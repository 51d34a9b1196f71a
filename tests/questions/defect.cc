#include "core/ensemble/parameter.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/temperature.h"
#include "tests/questions/draw.h"

namespace ballpiston::questions {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();

bool Uses(const ExperimentKind& experiment, const Parameter& parameter) {
  return std::any_of(experiment.parameters.begin(), experiment.parameters.end(),
                     [&](const ParameterUse& use) { return use.parameter == &parameter; });
}

// Makes the first value of the parameter one that lies slightly or far outside of its domain.
void SetValueOutside(Dice& dice, const Parameter& parameter, double bound, v1::Grid& grid) {
  const auto temperature = [&] {
    return dice.Pick<double>(
        {Below(kMinTemperature), Above(kMaxTemperature), 0, -1, kTiny, kNotANumber, kInfinity});
  };
  if (&parameter == &kRho) {
    grid.set_rho(0, dice.Pick<double>({kMinRho, Below(kMinRho), kMaxRho, Above(kMaxRho), 0, -0.53,
                                       1, 1e300, kNotANumber, kInfinity}));
  } else if (&parameter == &kDelta) {
    grid.set_delta(
        0, dice.Pick<double>({0, -kTiny, -0.1, bound * (1 + 3 * kDeltaSlack), bound * (1 + 1e-9),
                              2 * bound, 0.5, kNotANumber, kInfinity}));
  } else if (&parameter == &kEpsilon) {
    if (grid.epsilon().empty()) grid.add_epsilon(0);
    grid.set_epsilon(
        0, dice.Pick<double>({-kTiny, -0.1, Above(0.5), 1, 1e300, kNotANumber, -kInfinity}));
  } else if (&parameter == &kExponent) {
    grid.set_exponent(
        0, dice.Pick<double>({-kTiny, -1, Above(kMaxExponent), 1e300, kNotANumber, kInfinity}));
  } else if (&parameter == &kCells) {
    grid.set_cells(
        0, dice.Pick<std::string>({"0", "0x4", "4x0", "1000001", "1001x1000", "-1", "2.5", "x", "",
                                   "99999999999999999999", "3x3x3", "4294967296x4294967296"}));
  } else if (&parameter == &kTemperature) {
    if (grid.temperature().empty()) grid.add_temperature(1);
    grid.set_temperature(0, temperature());
  } else if (&parameter == &kCold) {
    grid.set_cold(0, temperature());
  } else {
    const bool is_below_cold = dice.Chance(0.5);
    grid.set_hot(0, is_below_cold ? std::nextafter(grid.cold(0), 0) : temperature());
  }
}

void SetCount(Dice& dice, int64_t count, v1::Target& target) {
  dice.Chance(0.5) ? target.set_collisions(count) : target.set_samples(count);
}

// Adds a defect and returns what it is.
std::string SomeDefect(Dice& dice, const ExperimentKind& experiment, double bound,
                       v1::EnsembleSpec& spec) {
  constexpr int kUnknown = 99;  // in no enumeration
  constexpr int kEach = 317;    // its square is above kMaxPoints
  v1::Grid& grid = *spec.mutable_grid();
  v1::Target& target = *spec.mutable_target();
  switch (dice.Below(28)) {
    case 0:
      if (!Uses(experiment, kEpsilon)) {
        grid.add_epsilon(0.1);
      } else if (!Uses(experiment, kHot)) {
        grid.add_hot(1);
      }
      return "a list is not used";
    case 1:
      dice.Chance(0.5) ? grid.clear_rho() : grid.clear_delta();
      return "a list is missing";
    case 2:
      target.Clear();
      SetCount(dice,
               dice.Pick<int64_t>({0, -1, kMaxSamples + 1, std::numeric_limits<int64_t>::min(),
                                   std::numeric_limits<int64_t>::max()}),
               target);
      return "the count is outside";
    case 3:
      target.set_tolerance(dice.Pick<double>({0, -0.01, 1, 1.5, kNotANumber}));
      return "the tolerance is outside";
    case 4:
      target.clear_kind();
      target.mutable_budget()->set_seconds(
          dice.Pick<int64_t>({0, -1, static_cast<int64_t>(kMaxBudgetSeconds)}));
      target.mutable_budget()->set_nanos(target.budget().seconds() > 0 ? 1 : 0);
      return "the budget is outside";
    case 5:
      SetCount(dice, 64, target);
      target.mutable_budget()->set_seconds(1);
      return "a count and a budget";
    case 6:
      spec.set_model(v1::EnsembleSpec::BILLIARD);
      spec.set_verify(true);
      return "verify is set with a model";
    case 7:
      spec.set_experiment(static_cast<v1::EnsembleSpec::Experiment>(kUnknown));
      return "the experiment is not known";
    case 8:
      spec.set_model(static_cast<v1::EnsembleSpec::Model>(kUnknown));
      return "the model is not known";
    case 9:
      spec.set_precision(static_cast<v1::EnsembleSpec::Precision>(kUnknown));
      return "the precision is not known";
    case 10:
      for (int i = 1; i < kEach; ++i) {
        grid.add_rho(grid.rho(0));
        grid.add_delta(grid.delta(0));
      }
      return "the grid has too many points";
    case 11:
      target.set_estimate("heat");
      return "the estimate is not known";
    default: {
      const ParameterUse& use = experiment.parameters[dice.Below(experiment.parameters.size())];
      SetValueOutside(dice, *use.parameter, bound, grid);
      return absl::StrCat("a value of ", use.parameter->name, " is outside");
    }
  }
}

}  // namespace

void AddDefect(Dice& dice, const ExperimentKind& experiment, double bound, Question& question) {
  question.defect = SomeDefect(dice, experiment, bound, question.spec);
}

}  // namespace ballpiston::questions
