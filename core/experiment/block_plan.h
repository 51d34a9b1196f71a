// How a point's samples are cut into blocks.
//
// The block size follows from the engine, the target and the predicted cost of a sample alone,
// never from threads or machines: some 2^20 events a block for the reference, 2^25 in lanes, so
// that a block takes about 0.05 s, and an eighth of that with a tolerance or a budget, of which the
// point has several blocks (the spec is that of one point): a tolerance
// is looked at after each block from the 16th on. It is a power of two, so that a rounding
// difference in the prediction does not change the plan, and small enough that a point has at least
// kMinBlocks of them to share out.
#ifndef BALLPISTON_CORE_EXPERIMENT_BLOCK_PLAN_H_
#define BALLPISTON_CORE_EXPERIMENT_BLOCK_PLAN_H_

#include <cstdint>
#include <optional>

#include "core/experiment/ensemble_spec.h"

namespace ballpiston {

inline constexpr uint64_t kMinBlocks = 16;

struct BlockPlan {
  // In all; with a tolerance or a budget the most that will be computed. 0: the answer needs none.
  uint64_t samples = 0;
  uint64_t block_size = 1;  // samples in each block but the last
  std::optional<double> tolerance = {};
  double events_per_sample = 1;  // predicted cost

  uint64_t Blocks() const { return (samples + block_size - 1) / block_size; }
  uint64_t FirstSample(uint64_t block) const { return block * block_size; }
  uint64_t SamplesIn(uint64_t block) const;
};

// That a target asks for at a point, where a sample takes so many collisions.
uint64_t SamplesAskedFor(const Target& target, double collisions_per_sample = 1);

// events_per_sample > 0, finite.
BlockPlan PlanBlocks(const EnsembleSpec& spec, double events_per_sample,
                     double collisions_per_sample = 1);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_BLOCK_PLAN_H_
