#include "core/experiment/all_experiments.h"

namespace ballpiston {

std::span<const ExperimentKind* const> AllExperiments() {
  static constexpr const ExperimentKind* kAll[] = {
      &kEquilibrium,    &kConditionalMeanFreeTime, &kFirstHit, &kEnergyRelaxation, &kMarkovProperty,
      &kGasEquilibrium, &kGasConduction,           &kLyapunov, &kGasLyapunov};
  return kAll;
}

}  // namespace ballpiston
