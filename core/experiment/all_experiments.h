// The list of all experiments. Each row is defined in its experiment's file.
#pragma once

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
extern const ExperimentKind kLyapunov;
extern const ExperimentKind kGasLyapunov;

inline constexpr std::array kAllExperiments = {
    &kEquilibrium,    &kConditionalMeanFreeTime, &kFirstHit, &kEnergyRelaxation, &kMarkovProperty,
    &kGasEquilibrium, &kGasConduction,           &kLyapunov, &kGasLyapunov};

}  // namespace ballpiston
