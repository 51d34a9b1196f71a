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

// A power of two.
uint64_t SamplesOf(double events, double events_per_sample, double most) {
  return std::bit_floor(static_cast<uint64_t>(std::clamp(events / events_per_sample, 1.0, most)));
}

}  // namespace

ChunkPlan::ChunkPlan(uint64_t samples, Engine engine, double events_per_sample, uint64_t together)
    : samples_(samples), events_per_sample_(events_per_sample), smallest_block_(together) {
  const NominalEvents& nominal = engine == Engine::kReference ? kByReference : kInLanes;
  seconds_per_event_ = nominal.seconds;
  constexpr double kMostInAChunk = 0x1p40;
  const uint64_t last =
      std::max(SamplesOf(nominal.last_chunk, events_per_sample, kMostInAChunk), together);
  base_ = std::max(SamplesOf(nominal.base, events_per_sample, kMostInAChunk),
                   std::min(kLeastJudged, last));
  doublings_ = static_cast<uint64_t>(std::countr_zero(last) - std::countr_zero(base_));
  largest_block_ = SamplesOf(nominal.block, events_per_sample, kMostInABlock);
}

uint64_t ChunkPlan::FullSize(uint64_t chunk) const { return base_ << std::min(chunk, doublings_); }

uint64_t ChunkPlan::FirstSample(uint64_t chunk) const {
  if (chunk <= doublings_) return (base_ << chunk) - base_;
  return (base_ << doublings_) - base_ + (chunk - doublings_) * FullSize(chunk);
}

uint64_t ChunkPlan::chunks() const {
  uint64_t chunk = 0;
  while (chunk < doublings_ && FirstSample(chunk) < samples_) ++chunk;
  if (FirstSample(chunk) >= samples_) return chunk;
  const uint64_t left = samples_ - FirstSample(chunk), size = FullSize(chunk);
  return chunk + (left + size - 1) / size;
}

uint64_t ChunkPlan::SamplesIn(uint64_t chunk) const {
  return std::min(FullSize(chunk), samples_ - FirstSample(chunk));
}

uint64_t ChunkPlan::BlockSize(uint64_t chunk) const {
  const uint64_t shared = std::max<uint64_t>(FullSize(chunk) / kBlocksInAChunk, 1);
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
  return base_ >= kLeastJudged || FirstSample(chunk + 1) % kLeastJudged == 0;
}

uint64_t ChunkPlan::ChunksFor(double samples) const {
  if (base_ < kLeastJudged) {
    samples = std::ceil(samples / kLeastJudged) * static_cast<double>(kLeastJudged);
  }
  if (!(samples < static_cast<double>(samples_))) return chunks();
  uint64_t chunk = 1;
  if (const double past = samples - static_cast<double>(FirstSample(doublings_)); past > 0) {
    chunk = doublings_ +
            static_cast<uint64_t>(std::ceil(past / static_cast<double>(FullSize(doublings_))));
  }
  while (static_cast<double>(FirstSample(chunk)) < samples) ++chunk;
  return chunk;
}

uint64_t ChunkPlan::SamplesBefore(uint64_t chunk) const {
  return std::min(FirstSample(chunk), samples_);
}

}  // namespace ballpiston
