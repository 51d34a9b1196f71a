#include "core/ensemble/chunk_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace ballpiston {
namespace {

struct NominalEvents {
  double seconds;     // of one event
  double block;       // 0.05 s or so
  double base;        // 3 ms
  double last_chunk;  // 43 s
};
constexpr NominalEvents kInLanes = {2.5e-9, 0x1p24, 0x1p20, 0x1p34};
constexpr NominalEvents kByReference = {40e-9, 0x1p20, 0x1p16, 0x1p30};

// Fewer samples are not enough to estimate an error (statistics/stated_error.h).
constexpr uint64_t kLeastJudged = 64;
constexpr uint64_t kBlocksInAChunk = 32;
constexpr double kMostInABlock = 0x1p16;
constexpr double kMostInAChunk = 0x1p40;

const NominalEvents& NominalOf(Engine engine) {
  return engine == Engine::kReference ? kByReference : kInLanes;
}

// A power of two.
uint64_t SamplesOf(double events, double events_per_sample, double most) {
  return std::bit_floor(static_cast<uint64_t>(std::clamp(events / events_per_sample, 1.0, most)));
}

}  // namespace

ChunkPlan::ChunkPlan(uint64_t samples, Engine engine, double events_per_sample, uint64_t together)
    : samples_(samples),
      steps_(samples),
      events_per_sample_(events_per_sample),
      smallest_block_(together) {
  const NominalEvents& nominal = NominalOf(engine);
  seconds_per_event_ = nominal.seconds;
  largest_ = std::max(SamplesOf(nominal.last_chunk, events_per_sample, kMostInAChunk), together);
  base_ = std::max(SamplesOf(nominal.base, events_per_sample, kMostInAChunk),
                   std::min(kLeastJudged, largest_));
  doublings_ = static_cast<uint64_t>(std::countr_zero(largest_) - std::countr_zero(base_));
  largest_block_ = SamplesOf(nominal.block, events_per_sample, kMostInABlock);
}

ChunkPlan::ChunkPlan(uint64_t samples, Engine engine, double events_per_sample,
                     const Trajectories& trajectories)
    : trajectories_(trajectories), events_per_sample_(events_per_sample) {
  const NominalEvents& nominal = NominalOf(engine);
  seconds_per_event_ = nominal.seconds;
  const uint64_t together = trajectories.count();
  steps_ = trajectories.warm_up + (samples + together - 1) / together;
  samples_ = steps_ * together;
  const double events_per_step = events_per_sample * static_cast<double>(trajectories.each);
  largest_ = SamplesOf(nominal.last_chunk, events_per_step, kMostInAChunk);
  if (trajectories.warm_up < largest_) {
    doublings_ = static_cast<uint64_t>(std::countr_zero(largest_)) + 1;
  }
}

uint64_t ChunkPlan::StepsBefore(uint64_t stage) const {
  const uint64_t doubled = std::min(stage, doublings_);
  const uint64_t equal = (stage - doubled) * largest_;
  if (groups() == 0) return (base_ << doubled) - base_ + equal;
  return (doubled == 0 ? 0 : trajectories_.warm_up + (uint64_t{1} << (doubled - 1))) + equal;
}

uint64_t ChunkPlan::StepsIn(uint64_t stage) const {
  return std::min(StepsBefore(stage + 1), steps_) - StepsBefore(stage);
}

uint64_t ChunkPlan::StagesWith(uint64_t steps) const {
  uint64_t stages = 0;
  while (stages < doublings_ && StepsBefore(stages) < steps) ++stages;
  const uint64_t before = StepsBefore(stages);
  return before >= steps ? stages : stages + (steps - before + largest_ - 1) / largest_;
}

uint64_t ChunkPlan::FirstSample(uint64_t chunk) const {
  const uint64_t stage = chunk / ChunksOfAStage(), before = chunk % ChunksOfAStage();
  const uint64_t first = SamplesOfAStep() * StepsBefore(stage);
  return before == 0 ? first : first + before * SamplesIn(chunk);
}

uint64_t ChunkPlan::SamplesIn(uint64_t chunk) const {
  return SamplesOfAStep() / ChunksOfAStage() * StepsIn(chunk / ChunksOfAStage());
}

uint64_t ChunkPlan::BlockSize(uint64_t chunk) const {
  if (groups() > 0) return SamplesIn(chunk);
  const uint64_t full = base_ << std::min(chunk, doublings_);
  const uint64_t shared = std::max<uint64_t>(full / kBlocksInAChunk, 1);
  return std::max(std::min(largest_block_, shared), smallest_block_);
}

uint64_t ChunkPlan::BlocksIn(uint64_t chunk) const {
  const uint64_t size = BlockSize(chunk);
  return (SamplesIn(chunk) + size - 1) / size;
}

Block ChunkPlan::BlockAt(uint64_t chunk, uint64_t index) const {
  const uint64_t size = BlockSize(chunk), before = index * size;
  return {.chunk = chunk,
          .index = index,
          .first = FirstSample(chunk) + before,
          .samples = std::min(size, SamplesIn(chunk) - before)};
}

bool ChunkPlan::IsJudgedAfter(uint64_t chunk) const {
  if (groups() > 0) return (chunk + 1) % groups() == 0 && FirstSample(chunk + 1) > warm_up();
  return base_ >= kLeastJudged || FirstSample(chunk + 1) % kLeastJudged == 0;
}

uint64_t ChunkPlan::ChunksFor(double samples) const {
  if (groups() == 0 && base_ < kLeastJudged) {
    samples = std::ceil(samples / kLeastJudged) * static_cast<double>(kLeastJudged);
  }
  samples += static_cast<double>(warm_up());
  if (!(samples < static_cast<double>(samples_))) return chunks();
  const double steps = std::ceil(samples / static_cast<double>(SamplesOfAStep()));
  return std::max<uint64_t>(StagesWith(static_cast<uint64_t>(steps)), 1) * ChunksOfAStage();
}

uint64_t ChunkPlan::FirstCutChunk() const {
  const uint64_t stages = StagesWith(steps_);
  const bool is_cut = stages > 0 && StepsBefore(stages) > steps_;
  return (is_cut ? stages - 1 : stages) * ChunksOfAStage();
}

uint64_t ChunkPlan::SamplesBefore(uint64_t chunk) const {
  return std::min(FirstSample(chunk), samples_);
}

}  // namespace ballpiston
