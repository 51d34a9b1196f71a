#include "core/ensemble/experiment_kind.h"

#include <algorithm>

namespace ballpiston {

bool ExperimentKind::IsAnsweredBy(Model model) const {
  return model == Model::kAuto || std::find(models.begin(), models.end(), model) != models.end();
}

const ExperimentKind* FindExperiment(uint64_t number) {
  for (const ExperimentKind* kind : AllExperiments()) {
    if (kind->number == number) return kind;
  }
  return nullptr;
}

}  // namespace ballpiston
