#include "core/ensemble/collision_sampler.h"

#include <algorithm>
#include <utility>

#include "core/billiard/exchange.h"

namespace ballpiston {
namespace {

// Collisions in progress or waiting: enough to keep the lanes full, and a bound of the memory.
constexpr double kMostOpen = 1 << 16;

constexpr double kSpeed = 1;  // sqrt(2 E) of a pair

}  // namespace

// Orbits do not depend on the division into blocks, so a block of orbits with many collisions is
// computed in parts.
CollisionSampler::CollisionSampler(const PointExperiment& experiment, const ExperimentKind& kind,
                                   std::function<bool()> pause)
    : experiment_(experiment),
      collisions_(kind.forecast(experiment.answer().model, experiment.parameters()).collisions),
      most_in_a_part_(static_cast<uint64_t>(kMostOpen / 4 / collisions_)),
      pause_(std::move(pause)),
      run_(experiment.StartRun(*this)) {}

std::optional<std::vector<CollisionRecord>> CollisionSampler::NextRecords() {
  if (!IsReady()) run_->Advance();
  if (HasEnded()) return std::nullopt;
  if (!IsReady()) return std::vector<CollisionRecord>();
  Part done = std::move(open_.front());
  open_.pop_front();
  open_samples_ -= done.block.samples;
  return InOrder(std::move(done));
}

std::vector<CollisionRecord> CollisionSampler::InOrder(Part part) const {
  std::ranges::stable_sort(part.records, {}, &OfOrbit::orbit);
  std::vector<CollisionRecord> records;
  records.reserve(part.records.size());
  for (const auto& [orbit, found] : part.records) {
    const bool goes_on = !records.empty() && orbit == part.records[records.size() - 1].orbit;
    CollisionRecord record = found;
    record.sample = part.block.first + (CountsOrbits() ? orbit : records.size());
    record.time = record.free_time + (goes_on ? records.back().time : 0);
    records.push_back(record);
  }
  return records;
}

CollisionSampler::Part& CollisionSampler::Find(const Block& block) {
  return *std::ranges::find(open_, block, &Part::block);
}

std::optional<Block> CollisionSampler::Next() {
  if (rest_.samples == 0) {
    if (!HasBlock()) return std::nullopt;
    rest_ = experiment_.plan().BlockAt(chunk_, index_);
    if (++index_ == experiment_.plan().BlocksIn(chunk_)) ++chunk_, index_ = 0;
  }
  Block part = rest_;
  if (CountsOrbits()) part.samples = std::min(part.samples, most_in_a_part_);
  if (open_samples_ + part.samples > 4 * most_in_a_part_ && !open_.empty()) return std::nullopt;
  rest_.first += part.samples;
  rest_.samples -= part.samples;
  open_.push_back({part});
  open_samples_ += part.samples;
  return part;
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
