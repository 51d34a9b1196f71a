#include "tests/questions/values.h"

namespace ballpiston::questions {
namespace {

bool Uses(const ExperimentKind& experiment, const Parameter& parameter) {
  for (const ParameterUse& use : experiment.parameters) {
    if (use.parameter == &parameter) return true;
  }
  return false;
}

void SetValueOutside(Dice& dice, const Parameter& parameter, double bound, v1::Grid& grid) {
  if (&parameter == &kRho) return grid.set_rho(0, RhoOutside(dice));
  if (&parameter == &kDelta) return grid.set_delta(0, DeltaOutside(dice, bound));
  if (&parameter == &kEpsilon) {
    if (grid.epsilon().empty()) grid.add_epsilon(0);
    return grid.set_epsilon(0, EpsilonOutside(dice));
  }
  if (&parameter == &kExponent) return grid.set_exponent(0, ExponentOutside(dice));
  if (&parameter == &kCells) return grid.set_cells(0, CellsOutside(dice));
  if (&parameter == &kTemperature) {
    if (grid.temperature().empty()) grid.add_temperature(1);
    return grid.set_temperature(0, TemperatureOutside(dice));
  }
  if (&parameter == &kCold) return grid.set_cold(0, TemperatureOutside(dice));
  const bool is_below_cold = dice.Chance(0.5);
  grid.set_hot(0, is_below_cold ? std::nextafter(grid.cold(0), 0) : TemperatureOutside(dice));
}

std::string ValueOutside(Dice& dice, const ExperimentKind& experiment, double bound,
                         v1::Grid& grid) {
  const ParameterUse& use = experiment.parameters[dice.Below(experiment.parameters.size())];
  SetValueOutside(dice, *use.parameter, bound, grid);
  return absl::StrCat("a value of ", use.parameter->name, " is outside");
}

std::string ListThatIsNotUsed(const ExperimentKind& experiment, v1::Grid& grid) {
  if (!Uses(experiment, kEpsilon)) {
    grid.add_epsilon(0.1);
  } else if (!Uses(experiment, kHot)) {
    grid.add_hot(1);
  }
  return "a list is not used";
}

std::string ListThatIsMissing(Dice& dice, v1::Grid& grid) {
  dice.Chance(0.5) ? grid.clear_rho() : grid.clear_delta();
  return "a list is missing";
}

std::string CountOutside(Dice& dice, v1::Target& target) {
  target.Clear();
  const auto count =
      dice.Pick<int64_t>({0, -1, kMaxSamples + 1, std::numeric_limits<int64_t>::min(),
                          std::numeric_limits<int64_t>::max()});
  dice.Chance(0.5) ? target.set_collisions(count) : target.set_samples(count);
  return "the count is outside";
}

std::string ToleranceOutside(Dice& dice, v1::Target& target) {
  target.set_tolerance(
      dice.Pick<double>({0, -0.01, 1, 1.5, std::numeric_limits<double>::quiet_NaN()}));
  return "the tolerance is outside";
}

std::string BudgetOutside(Dice& dice, v1::Target& target) {
  target.clear_kind();
  const auto seconds = dice.Pick<int64_t>({0, -1, static_cast<int64_t>(kMaxBudgetSeconds)});
  target.mutable_budget()->set_seconds(seconds);
  target.mutable_budget()->set_nanos(seconds > 0 ? 1 : 0);
  return "the budget is outside";
}

std::string CountWithABudget(Dice& dice, v1::Target& target) {
  dice.Chance(0.5) ? target.set_collisions(64) : target.set_samples(64);
  target.mutable_budget()->set_seconds(1);
  return "a count and a budget";
}

std::string VerifyWithAModel(const ExperimentKind&, v1::EnsembleSpec& spec) {
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  spec.set_verify(true);
  return "verify is set with a model";
}

std::string UnknownNumber(Dice& dice, v1::EnsembleSpec& spec) {
  constexpr int kUnknown = 99;
  switch (dice.Below(3)) {
    case 0:
      spec.set_experiment(static_cast<v1::EnsembleSpec::Experiment>(kUnknown));
      break;
    case 1:
      spec.set_model(static_cast<v1::EnsembleSpec::Model>(kUnknown));
      break;
    default:
      spec.set_precision(static_cast<v1::EnsembleSpec::Precision>(kUnknown));
  }
  return "a number of an enumeration is not known";
}

std::string TooManyPoints(v1::Grid& grid) {
  constexpr int kEach = 317;  // its square is above kMaxPoints
  const double rho = grid.rho(0), delta = grid.delta(0);
  for (int i = 1; i < kEach; ++i) {
    grid.add_rho(rho);
    grid.add_delta(delta);
  }
  return "the grid has too many points";
}

std::string SomeDefect(Dice& dice, const ExperimentKind& experiment, double bound,
                       v1::EnsembleSpec& spec) {
  v1::Grid& grid = *spec.mutable_grid();
  v1::Target& target = *spec.mutable_target();
  switch (dice.Below(24)) {
    case 0:
      return ListThatIsNotUsed(experiment, grid);
    case 1:
      return ListThatIsMissing(dice, grid);
    case 2:
      return CountOutside(dice, target);
    case 3:
      return ToleranceOutside(dice, target);
    case 4:
      return BudgetOutside(dice, target);
    case 5:
      return CountWithABudget(dice, target);
    case 6:
      return VerifyWithAModel(experiment, spec);
    case 7:
      return UnknownNumber(dice, spec);
    case 8:
      if (dice.Chance(0.5)) return TooManyPoints(grid);
      target.set_estimate("heat");
      return "the estimate is not known";
    default:
      return ValueOutside(dice, experiment, bound, grid);
  }
}

}  // namespace

void AddDefect(Dice& dice, const ExperimentKind& experiment, double bound, Question& question) {
  question.defect = SomeDefect(dice, experiment, bound, question.spec);
}

}  // namespace ballpiston::questions
