#include "core/experiment/ensemble_spec.h"

namespace ballpiston {

absl::string_view Name(Experiment experiment) {
  switch (experiment) {
    case Experiment::kUnspecified:
      return "unspecified";
    case Experiment::kEquilibrium:
      return "equilibrium";
    case Experiment::kConditionalMeanFreeTime:
      return "conditional-mean-free-time";
    case Experiment::kFirstHit:
      return "first-hit";
    case Experiment::kEnergyRelaxation:
      return "energy-relaxation";
    case Experiment::kMarkovProperty:
      return "markov-property";
  }
  return "unknown";
}

absl::string_view Name(Model model) {
  switch (model) {
    case Model::kAuto:
      return "auto";
    case Model::kClosedForm:
      return "closed_form";
    case Model::kSpectrum:
      return "spectrum";
    case Model::kMarkov:
      return "markov";
    case Model::kBilliard:
      return "billiard";
    case Model::kBilliardReference:
      return "billiard_reference";
  }
  return "unknown";
}

absl::string_view Name(Precision precision) {
  switch (precision) {
    case Precision::kDouble:
      return "double";
    case Precision::kSingle:
      return "single";
  }
  return "unknown";
}

size_t PointCount(const EnsembleSpec& spec) {
  const auto factor = [](const auto& list) { return list.empty() ? size_t{1} : list.size(); };
  return factor(spec.grid.rho) * factor(spec.grid.delta) * factor(spec.grid.epsilon) *
         factor(spec.grid.exponent);
}

PointParameters PointAt(const EnsembleSpec& spec, size_t index) {
  // Takes the index apart from the innermost list outwards.
  const auto take = [&index](const std::vector<double>& list) -> std::optional<double> {
    if (list.empty()) return std::nullopt;
    const double value = list[index % list.size()];
    index /= list.size();
    return value;
  };
  PointParameters point;
  point.exponent = take(spec.grid.exponent);
  point.epsilon = take(spec.grid.epsilon);
  point.delta = *take(spec.grid.delta);
  point.rho = *take(spec.grid.rho);
  return point;
}

EnsembleSpec OnePointSpec(const EnsembleSpec& spec, const PointParameters& point, Model model) {
  EnsembleSpec one = {.experiment = spec.experiment,
                      .grid = {.rho = {point.rho}, .delta = {point.delta}},
                      .target = spec.target,
                      .seed = spec.seed,
                      .model = model,
                      .precision = spec.precision,
                      .verify = spec.verify};
  if (point.epsilon) one.grid.epsilon = {*point.epsilon};
  if (point.exponent) one.grid.exponent = {*point.exponent};
  if (one.target.budget_seconds) {
    *one.target.budget_seconds /= static_cast<double>(PointCount(spec));
  }
  return one;
}

}  // namespace ballpiston
