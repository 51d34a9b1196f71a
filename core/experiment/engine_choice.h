// Which engine runs the orbits of a specification.
#ifndef BALLPISTON_CORE_EXPERIMENT_ENGINE_CHOICE_H_
#define BALLPISTON_CORE_EXPERIMENT_ENGINE_CHOICE_H_

#include "core/billiard/orbits.h"
#include "core/experiment/ensemble_spec.h"

namespace ballpiston {

// AUTO stays with the reference until the lanes have been through every degenerate case.
inline Engine EngineFor(const EnsembleSpec& spec) {
  if (spec.model != Model::kBilliard) return Engine::kReference;
  return spec.precision == Precision::kSingle ? Engine::kLanesSingle : Engine::kLanes;
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_ENGINE_CHOICE_H_
