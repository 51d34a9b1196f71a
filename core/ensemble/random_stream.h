// The random numbers of a point.
#pragma once

#include <cstdint>

#include "core/ensemble/ensemble_spec.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {

// The random numbers of a point, by sample.
struct RandomStream {
  uint64_t seed;
  uint64_t stream;

  CounterRandom Sample(uint64_t sample) const { return {seed, stream, sample}; }
};

// The stream of a point: a 64-bit hash of the experiment, the parameters and the kind of model
// (billiard or jump process). So the points of a grid are independent under one seed, and a point's
// numbers do not depend on its grid. The hash determines the bits of every result.
uint64_t PointStream(const EnsembleSpec& spec, const PointParameters& parameters);

}  // namespace ballpiston
