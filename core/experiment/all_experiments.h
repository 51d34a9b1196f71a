// The list of all experiments. Each row is defined in its experiment's file.
#ifndef BALLPISTON_CORE_EXPERIMENT_ALL_EXPERIMENTS_H_
#define BALLPISTON_CORE_EXPERIMENT_ALL_EXPERIMENTS_H_

#include <array>

#include "core/ensemble/experiment_kind.h"

namespace ballpiston {

extern const ExperimentKind kEquilibrium;
extern const ExperimentKind kConditionalMeanFreeTime;
extern const ExperimentKind kFirstHit;
extern const ExperimentKind kEnergyRelaxation;
extern const ExperimentKind kMarkovProperty;
extern const ExperimentKind kGasEquilibrium;
extern const ExperimentKind kGasConduction;

inline constexpr std::array kAllExperiments = {
    &kEquilibrium,    &kConditionalMeanFreeTime, &kFirstHit,     &kEnergyRelaxation,
    &kMarkovProperty, &kGasEquilibrium,          &kGasConduction};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_ALL_EXPERIMENTS_H_
