// Merges the blocks of one point strictly in the order of their indices.
//
// Blocks arrive in any order, from any number of threads and from the store; one that comes early
// waits until all before it are merged. What was merged is therefore the same, bit for bit, however
// the blocks were computed. Once the target is reached the point is finished, and every block
// beyond is dropped. Property, with a test of its name:
//   1. ResultIsIndependentOfArrivalOrder.
// Not thread-safe.
#ifndef BALLPISTON_SERVER_EXECUTION_ORDERED_MERGE_H_
#define BALLPISTON_SERVER_EXECUTION_ORDERED_MERGE_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>

#include "core/experiment/block_result.h"
#include "core/experiment/point_experiment.h"

namespace ballpiston::server {

class OrderedMerge {
 public:
  // Called for each block when its turn has come, after it was merged; the result may be moved.
  using OnMerged = std::function<void(uint64_t block, BlockResult& result)>;

  explicit OrderedMerge(std::shared_ptr<const PointExperiment> experiment);

  // Takes a block's result. One that is known already, or lies beyond the end, is dropped: the
  // first one wins (they are equal anyway).
  void Add(uint64_t block, BlockResult result, const OnMerged& on_merged);

  // What is merged is enough; blocks that wait are dropped.
  void Finish();

  bool Knows(uint64_t block) const;  // merged or waiting
  bool finished() const { return finished_; }
  uint64_t blocks_merged() const { return blocks_merged_; }
  size_t waiting() const { return early_.size(); }
  const BlockResult& merged() const { return merged_; }

 private:
  void MergeNext(BlockResult result, const OnMerged& on_merged);

  std::shared_ptr<const PointExperiment> experiment_;
  BlockResult merged_;
  uint64_t blocks_merged_ = 0;
  bool finished_;
  std::map<uint64_t, BlockResult> early_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_ORDERED_MERGE_H_
