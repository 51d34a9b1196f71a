// The random stream of a point: a 64-bit hash of what is computed there (experiment and
// parameters), so that points of a grid are independent under one seed, and a point's numbers do
// not depend on which grid it stands in. Fixed for ever: it decides the bits of every result.
#ifndef BALLPISTON_CORE_EXPERIMENT_POINT_STREAM_H_
#define BALLPISTON_CORE_EXPERIMENT_POINT_STREAM_H_

#include <cstdint>

#include "core/experiment/ensemble_spec.h"

namespace ballpiston {

uint64_t PointStream(Experiment experiment, const PointParameters& parameters);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_POINT_STREAM_H_
