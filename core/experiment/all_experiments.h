// The rows of all experiments. Each row is defined in its experiment's file.
#pragma once

#include "core/ensemble/experiment_kind.h"

namespace ballpiston {

extern const ExperimentKind kEquilibrium;
extern const ExperimentKind kConditionalMeanFreeTime;
extern const ExperimentKind kFirstHit;
extern const ExperimentKind kEnergyRelaxation;
extern const ExperimentKind kMarkovProperty;
extern const ExperimentKind kGasEquilibrium;
extern const ExperimentKind kGasConduction;
extern const ExperimentKind kLyapunov;
extern const ExperimentKind kGasLyapunov;

// What AllExperiments of ensemble/experiment_kind.h returns.
inline constexpr const ExperimentKind* kAllExperiments[] = {
    &kEquilibrium,    &kConditionalMeanFreeTime, &kFirstHit, &kEnergyRelaxation, &kMarkovProperty,
    &kGasEquilibrium, &kGasConduction,           &kLyapunov, &kGasLyapunov};

}  // namespace ballpiston
