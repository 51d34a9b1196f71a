#include "core/experiment/all_experiments.h"

namespace ballpiston {

std::span<const ExperimentKind* const> AllExperiments() { return kAllExperiments; }

}  // namespace ballpiston
