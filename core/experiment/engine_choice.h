// Which engine runs the orbits of a specification.
#ifndef BALLPISTON_CORE_EXPERIMENT_ENGINE_CHOICE_H_
#define BALLPISTON_CORE_EXPERIMENT_ENGINE_CHOICE_H_

#include "core/billiard/orbits.h"
#include "core/experiment/ensemble_spec.h"

namespace ballpiston {

// In double precision the lanes are as exact as the reference; AUTO takes the quicker.
inline Engine EngineFor(const EnsembleSpec& spec) {
  if (spec.model == Model::kBilliardReference) return Engine::kReference;
  return spec.precision == Precision::kSingle ? Engine::kLanesSingle : Engine::kLanes;
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_ENGINE_CHOICE_H_
