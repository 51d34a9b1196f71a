// Questions as text, as a user writes them: an experiment, and what differs from one point of it.
//
//   Asked("first-hit delta=0.2 samples=1000 model=billiard")
//
// One point is at the paper's rho and delta = 0.1; where they are needed epsilon is 1/8, the
// exponent 1, the cells two in a row, the temperature 2, the reservoirs at 1.5 and 0.5. Names:
// parameters (with lists of numbers; cells also NxM), samples, collisions, tolerance, budget,
// estimate, model, seed, precision=single and verify=yes. Another name fails the test.
#pragma once

#include "tests/core/one_point_spec.h"
#include "tests/support/preamble.h"

namespace ballpiston {

inline constexpr Model kAllModels[] = {Model::kAuto,     Model::kClosedForm,
                                       Model::kSpectrum, Model::kMarkov,
                                       Model::kBilliard, Model::kBilliardReference};

inline EnsembleSpec OnePointOf(const ExperimentKind* experiment) {
  PointParameters point = PaperPoint(0.1);
  if (experiment == &kConditionalMeanFreeTime) point = PaperPoint(0.1, 0.125);
  if (experiment == &kFirstHit) point = PaperPoint(0.1, 0.125, 1);
  if (IsOfAGas(experiment)) point = PaperGas(experiment, 0.1);
  return SpecOf(experiment, point);
}

inline double ValueOf(const Parameter* parameter, const std::string& text) {
  const bool is_lattice = parameter == &kCells && text.find('x') != std::string::npos;
  return is_lattice ? CodeOf(ParseGasShape(text).value()) : std::strtod(text.c_str(), nullptr);
}

inline void SetPart(EnsembleSpec& spec, const std::string& name, const std::string& value) {
  for (const Parameter* parameter : kParameters) {
    if (name != parameter->name) continue;
    spec.grid[*parameter] = {};
    for (const absl::string_view number : absl::StrSplit(value, ',', absl::SkipEmpty())) {
      spec.grid[*parameter].push_back(ValueOf(parameter, std::string(number)));
    }
    return;
  }
  for (const Model model : kAllModels) {
    if (name != "model" || value != Name(model)) continue;
    spec.model = model;
    return;
  }
  const double number = std::strtod(value.c_str(), nullptr);
  if (name == "samples") {
    spec.target.samples = static_cast<int64_t>(number);
  } else if (name == "collisions") {
    spec.target.collisions = static_cast<int64_t>(number);
  } else if (name == "tolerance") {
    spec.target.tolerance = number;
  } else if (name == "budget") {
    spec.target.budget_seconds = number;
  } else if (name == "estimate") {
    spec.target.estimate = value;
  } else if (name == "seed") {
    spec.seed = static_cast<uint64_t>(number);
  } else if (name == "precision" && value == "single") {
    spec.precision = Precision::kSingle;
  } else if (name == "verify") {
    spec.verify = true;
  } else {
    ADD_FAILURE() << "an unknown part of a question: " << name << "=" << value;
  }
}

inline EnsembleSpec Asked(const std::string& question) {
  const std::vector<std::string> words = absl::StrSplit(question, ' ');
  EnsembleSpec spec;
  for (const ExperimentKind* experiment : AllExperiments()) {
    if (experiment->name == words[0]) spec = OnePointOf(experiment);
  }
  EXPECT_NE(spec.experiment, nullptr) << "an unknown experiment: " << words[0];
  for (size_t i = 1; i < words.size(); ++i) {
    const std::vector<std::string> sides = absl::StrSplit(words[i], '=');
    SetPart(spec, sides.at(0), sides.at(1));
  }
  return spec;
}

// All questions that a text with alternatives makes: "first-hit delta={0.1|0.2}" makes two.
inline std::vector<std::string> QuestionsOf(const std::string& text) {
  const size_t open = text.find('{'), close = text.find('}');
  if (open == std::string::npos) return {text};
  const std::vector<std::string> alternatives =
      absl::StrSplit(text.substr(open + 1, close - open - 1), '|');
  std::vector<std::string> questions;
  for (const std::string& alternative : alternatives) {
    const auto some = QuestionsOf(text.substr(0, open) + alternative + text.substr(close + 1));
    questions.insert(questions.end(), some.begin(), some.end());
  }
  return questions;
}

// Matchers of a violation: of this field, and with these parts of its description.
inline auto OfField(const std::string& field) { return Field(&FieldViolation::field, field); }

template <typename... Parts>
auto Saying(const Parts&... parts) {
  return Field(&FieldViolation::description, AllOf(HasSubstr(parts)...));
}

template <typename... Parts>
auto Names(const std::string& field, const Parts&... parts) {
  return AllOf(OfField(field), Saying(parts...));
}

}  // namespace ballpiston
