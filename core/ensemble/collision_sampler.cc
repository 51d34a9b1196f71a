#include "core/ensemble/collision_sampler.h"

#include <algorithm>
#include <utility>

#include "core/billiard/exchange.h"

namespace ballpiston {
namespace {

// Samples in progress or waiting, enough to keep the lanes full where blocks are small. A block of
// as many samples is the only one beside the block that is read.
constexpr uint64_t kMostOpen = 1 << 16;

constexpr double kSpeed = 1;  // sqrt(2 E) of a pair

}  // namespace

CollisionSampler::CollisionSampler(const PointExperiment& experiment, TargetUnit unit)
    : experiment_(experiment), unit_(unit), run_(experiment.StartRun(*this)) {}

std::vector<CollisionRecord> CollisionSampler::NextRecords() {
  while (!Pause()) {
    const bool has_ended = run_->Advance() && open_.empty();
    if (has_ended) return {};
  }
  OpenBlock done = std::move(open_.front());
  open_.pop_front();
  open_samples_ -= done.block.samples;
  return InOrder(std::move(done));
}

std::vector<CollisionRecord> CollisionSampler::InOrder(OpenBlock open) const {
  std::ranges::stable_sort(open.records, {}, &OfOrbit::orbit);
  std::vector<CollisionRecord> records;
  records.reserve(open.records.size());
  for (const auto& [orbit, found] : open.records) {
    const bool goes_on = !records.empty() && orbit == open.records[records.size() - 1].orbit;
    CollisionRecord record = found;
    record.sample = open.block.first + (unit_ == TargetUnit::kSamples ? orbit : records.size());
    record.time = record.free_time + (goes_on ? records.back().time : 0);
    records.push_back(record);
  }
  return records;
}

CollisionSampler::OpenBlock& CollisionSampler::Find(const Block& block) {
  return *std::ranges::find(open_, block, &OpenBlock::block);
}

std::optional<Block> CollisionSampler::Next() {
  const ChunkPlan& plan = experiment_.plan();
  if (open_samples_ >= kMostOpen || chunk_ == plan.chunks()) return std::nullopt;
  const Block block = plan.BlockAt(chunk_, index_);
  if (++index_ == plan.BlocksIn(chunk_)) {
    ++chunk_;
    index_ = 0;
  }
  open_.push_back({block});
  open_samples_ += block.samples;
  return block;
}

void CollisionSampler::Done(const Block& block, BlockResult) { Find(block).is_done = true; }

void CollisionSampler::Observe(const Block& block, uint64_t orbit, const Collision& collision) {
  if (collision.escaped || collision.expired) return;
  Find(block).records.push_back({orbit,
                                 {.free_time = collision.time,
                                  .before = collision.state,
                                  .after = AfterExchange(collision.state, kSpeed)}});
}

}  // namespace ballpiston
