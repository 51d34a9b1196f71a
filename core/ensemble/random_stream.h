// The random numbers of a point, by sample.
#ifndef BALLPISTON_CORE_ENSEMBLE_RANDOM_STREAM_H_
#define BALLPISTON_CORE_ENSEMBLE_RANDOM_STREAM_H_

#include <cstdint>

#include "core/sampling/counter_random.h"

namespace ballpiston {

struct RandomStream {
  uint64_t seed;
  uint64_t stream;

  CounterRandom Sample(uint64_t sample) const { return {seed, stream, sample}; }
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_ENSEMBLE_RANDOM_STREAM_H_
