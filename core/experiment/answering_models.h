// The ladder of models, and which experiments each can answer.
#ifndef BALLPISTON_CORE_EXPERIMENT_ANSWERING_MODELS_H_
#define BALLPISTON_CORE_EXPERIMENT_ANSWERING_MODELS_H_

#include "core/experiment/ensemble_spec.h"

namespace ballpiston {

inline constexpr Model kAllModels[] = {Model::kAuto,     Model::kClosedForm,
                                       Model::kSpectrum, Model::kMarkov,
                                       Model::kBilliard, Model::kBilliardReference};

// Cheapest first.
inline constexpr Model kLadder[] = {Model::kClosedForm, Model::kSpectrum, Model::kMarkov,
                                    Model::kBilliard, Model::kBilliardReference};

// Whether all that the experiment is about has a closed form. Not first-hit: it asks for a measured
// law, at exponent 1 too.
constexpr bool HasClosedForm(Experiment experiment) {
  return experiment == Experiment::kEquilibrium ||
         experiment == Experiment::kConditionalMeanFreeTime;
}

// kAuto and the billiards answer everything.
constexpr bool Answers(Model model, Experiment experiment) {
  switch (model) {
    case Model::kClosedForm:
      return HasClosedForm(experiment);
    case Model::kSpectrum:
      return experiment == Experiment::kEnergyRelaxation;
    case Model::kMarkov:
      return experiment == Experiment::kEnergyRelaxation ||
             experiment == Experiment::kMarkovProperty;
    case Model::kAuto:
    case Model::kBilliard:
    case Model::kBilliardReference:
      break;
  }
  return true;
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_ANSWERING_MODELS_H_
