#include "core/experiment/block_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/experiment/engine_choice.h"

namespace ballpiston {
namespace {

constexpr double kReferenceEventsPerBlock = 0x1p20;
constexpr double kLaneEventsPerBlock = 0x1p25;
constexpr double kShareOfAnOpenEnd = 0.125;
// Nominal speeds: blocks must not depend on the machine. A budget has several blocks.
constexpr double kReferenceEventsPerSecond = 2e7;
constexpr double kLaneEventsPerSecond = 3e8;
constexpr double kBlocksInABudget = 8;
constexpr uint64_t kMaxBlockSize = uint64_t{1} << 16;

double EventsPerBlock(const Target& target, bool by_reference) {
  const double events = by_reference ? kReferenceEventsPerBlock : kLaneEventsPerBlock;
  const double speed = by_reference ? kReferenceEventsPerSecond : kLaneEventsPerSecond;
  if (!target.tolerance && !target.budget_seconds) return events;
  if (!target.budget_seconds) return events * kShareOfAnOpenEnd;
  return std::min(events * kShareOfAnOpenEnd, speed * *target.budget_seconds / kBlocksInABudget);
}

bool IsOpenEnded(const Target& target) { return target.tolerance || target.budget_seconds; }

}  // namespace

uint64_t SamplesAskedFor(const Target& target, double collisions_per_sample) {
  if (IsOpenEnded(target)) return kMaxSamples;
  if (!target.collisions) return static_cast<uint64_t>(target.samples.value_or(kDefaultSamples));
  return static_cast<uint64_t>(
      std::ceil(static_cast<double>(*target.collisions) / collisions_per_sample));
}

BlockPlan PlanBlocks(const EnsembleSpec& spec, double events_per_sample,
                     double collisions_per_sample) {
  const Target& target = spec.target;
  const uint64_t samples = SamplesAskedFor(target, collisions_per_sample);
  const double events = EventsPerBlock(target, EngineFor(spec) == Engine::kReference);
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
