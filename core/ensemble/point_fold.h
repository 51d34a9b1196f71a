// The state of one point during its computation: the next block, and the merged result.
//
// The fold merges blocks into their chunk in the order of their indices, and chunks into the point
// in the order of theirs. Blocks may arrive in any order, from any number of threads. A block that
// arrives early waits until all blocks before it are merged. So the merged result has the same bits
// for every order of arrival. The fold judges a tolerance when a chunk is complete. When the target
// is reached, the point is finished, and the fold drops every later block. Properties, each with a
// test of its name:
//   1. ResultIsIndependentOfArrivalOrder.  2. ResumedFoldGivesTheSameBits.
// Not thread-safe.
#ifndef BALLPISTON_CORE_ENSEMBLE_POINT_FOLD_H_
#define BALLPISTON_CORE_ENSEMBLE_POINT_FOLD_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <utility>

#include "core/ensemble/block_result.h"
#include "core/ensemble/chunk_plan.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston {

// The merged result, from which a fold can be resumed.
struct FoldState {
  uint64_t chunk = 0;         // the first chunk that is not complete
  uint64_t blocks = 0;        // the number of merged blocks of that chunk
  BlockResult complete = {};  // the merged result of all complete chunks
  BlockResult partial = {};   // the merged blocks of that chunk
};

class PointFold {
 public:
  // The experiment must outlive the fold.
  explicit PointFold(const PointExperiment& experiment);

  // The maximum number of blocks that are handed out but not merged. It bounds the memory of blocks
  // that wait for a slow one. A smaller window would leave lanes empty.
  static constexpr uint64_t kWindow = 1024;

  // Returns each block once; empty if no block may be handed out now.
  std::optional<Block> NextBlock();
  bool HasNextBlock() const;

  // Takes a block's result. Drops a block that it already has (the two results are equal) and a
  // block beyond the end. Returns the number of samples of all blocks that this call merged.
  uint64_t Add(const Block& block, BlockResult result);

  // Ends the point with the merged result and drops waiting blocks.
  void Finish();

  // Continues from a state of the same experiment. Must be called before any block is handed out.
  void Resume(FoldState state);

  bool finished() const { return finished_; }
  const FoldState& state() const { return state_; }
  bool HasBlocks() const { return state_.chunk > 0 || state_.blocks > 0; }
  BlockResult Merged() const;       // the result of all merged blocks
  uint64_t PlannedSamples() const;  // of all merged blocks; escaped orbits count
  size_t waiting() const { return early_.size(); }

 private:
  using Place = std::pair<uint64_t, uint64_t>;  // chunk, index

  Place NextPlace() const { return {state_.chunk, state_.blocks}; }
  uint64_t MergeNext(const BlockResult& result);
  void CompleteChunk();

  const PointExperiment& experiment_;
  const uint64_t chunks_;
  FoldState state_;
  bool finished_;
  Place next_ = {0, 0};      // of the next block to hand out
  uint64_t handed_out_ = 0;  // blocks that are handed out but not merged
  std::map<Place, BlockResult> early_;
};

// Computes a whole point on the calling thread. Empty if `stop` was requested before the end.
std::optional<BlockResult> FoldPoint(const PointExperiment& experiment,
                                     const std::stop_token& stop = {});

// Computes one block on the calling thread. Empty if `stop` was requested before the end.
std::optional<BlockResult> RunBlock(const PointExperiment& experiment, const Block& block,
                                    const std::stop_token& stop = {});

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_ENSEMBLE_POINT_FOLD_H_
