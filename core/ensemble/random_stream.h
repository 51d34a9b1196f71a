// The random numbers of a point, by sample.
#pragma once

#include <cstdint>

#include "core/sampling/counter_random.h"

namespace ballpiston {

struct RandomStream {
  uint64_t seed;
  uint64_t stream;

  CounterRandom Sample(uint64_t sample) const { return {seed, stream, sample}; }
};

}  // namespace ballpiston
