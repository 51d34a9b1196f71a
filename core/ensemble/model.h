// The ladder of models, and the precision of the billiard's lanes.
#pragma once

#include <cstddef>
#include <iterator>

#include "absl/strings/string_view.h"

namespace ballpiston {

// kMarkov: the jump process of the limit delta -> 0, sampled. kSpectrum: the same process, computed
// from its generator. kAuto: the service chooses.
enum class Model { kAuto, kClosedForm, kSpectrum, kMarkov, kBilliard, kBilliardReference };

// Cheapest first.
inline constexpr Model kLadder[] = {Model::kClosedForm, Model::kSpectrum, Model::kMarkov,
                                    Model::kBilliard, Model::kBilliardReference};

enum class Precision { kDouble, kSingle };

constexpr bool IsOfTheLimit(Model model) {
  return model == Model::kSpectrum || model == Model::kMarkov;
}

constexpr bool IsABilliard(Model model) {
  return model == Model::kBilliard || model == Model::kBilliardReference;
}

// Requires a model other than AUTO.
constexpr bool TakesSamples(Model model) {
  return model != Model::kClosedForm && model != Model::kSpectrum;
}

// The model itself; for AUTO the billiard, which answers every experiment by samples.
constexpr Model Sampled(Model model) { return model == Model::kAuto ? Model::kBilliard : model; }

// The name as users write it. The name of a number that is not a Model is "unknown".
constexpr absl::string_view Name(Model model) {
  // In the order of the enumeration.
  constexpr absl::string_view kNames[] = {"auto",   "closed_form", "spectrum",
                                          "markov", "billiard",    "billiard_reference"};
  static_assert(std::size(kNames) == static_cast<size_t>(Model::kBilliardReference) + 1);
  const auto index = static_cast<size_t>(model);
  return index < std::size(kNames) ? kNames[index] : "unknown";
}

constexpr absl::string_view Name(Precision precision) {
  return precision == Precision::kSingle ? "single" : "double";
}

}  // namespace ballpiston
