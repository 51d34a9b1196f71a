#include "core/experiment/block_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace ballpiston {
namespace {

constexpr double kEventsPerBlock = 0x1p20;
constexpr double kEventsPerBlockOfATolerance = 0x1p17;
constexpr uint64_t kMaxBlockSize = uint64_t{1} << 16;

uint64_t SamplesAskedFor(const Target& target) {
  if (target.tolerance) return kMaxSamples;
  return static_cast<uint64_t>(
      target.samples.value_or(target.collisions.value_or(kDefaultSamples)));
}

}  // namespace

BlockPlan PlanBlocks(const Target& target, double events_per_sample) {
  const uint64_t samples = SamplesAskedFor(target);
  const double events = target.tolerance ? kEventsPerBlockOfATolerance : kEventsPerBlock;
  const double affordable =
      std::clamp(events / events_per_sample, 1.0, static_cast<double>(kMaxBlockSize));
  const uint64_t divisible = std::max<uint64_t>(samples / kMinBlocks, 1);
  return {.samples = samples,
          .block_size = std::bit_floor(std::min(static_cast<uint64_t>(affordable), divisible)),
          .tolerance = target.tolerance,
          .events_per_sample = events_per_sample};
}

uint64_t BlockPlan::SamplesIn(uint64_t block) const {
  return std::min(block_size, samples - FirstSample(block));
}

}  // namespace ballpiston
