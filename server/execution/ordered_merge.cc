#include "server/execution/ordered_merge.h"

#include <utility>

namespace ballpiston::server {

OrderedMerge::OrderedMerge(std::shared_ptr<const PointExperiment> experiment)
    : experiment_(std::move(experiment)), finished_(experiment_->plan().Blocks() == 0) {}

bool OrderedMerge::Knows(uint64_t block) const {
  return block < blocks_merged_ || early_.contains(block);
}

void OrderedMerge::Add(uint64_t block, BlockResult result, const OnMerged& on_merged) {
  if (finished_ || Knows(block)) return;
  early_.emplace(block, std::move(result));
  while (!finished_ && !early_.empty() && early_.begin()->first == blocks_merged_) {
    MergeNext(std::move(early_.extract(early_.begin()).mapped()), on_merged);
  }
  if (finished_) Finish();
}

void OrderedMerge::Finish() {
  finished_ = true;
  early_.clear();
}

void OrderedMerge::MergeNext(BlockResult result, const OnMerged& on_merged) {
  merged_.Merge(result);
  const uint64_t block = blocks_merged_++;
  finished_ = blocks_merged_ >= experiment_->plan().Blocks() ||
              experiment_->TargetReached(blocks_merged_, merged_);
  if (on_merged) on_merged(block, result);
}

}  // namespace ballpiston::server
