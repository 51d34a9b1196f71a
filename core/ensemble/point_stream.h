// The random stream of a point: a 64-bit hash of the experiment, the parameters, the kind of model
// (billiard or jump process) and the purpose (answer or pilot). So the points of a grid are
// independent under one seed, and a point's numbers do not depend on its grid. The hash determines
// the bits of every result.
#pragma once

#include <cstdint>

#include "core/ensemble/ensemble_spec.h"

namespace ballpiston {

uint64_t PointStream(const EnsembleSpec& spec, const PointParameters& parameters);

}  // namespace ballpiston
