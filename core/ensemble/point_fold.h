// The state of one point during its computation: the merged result of its chunks.
//
// The fold merges chunks into the point in order. A chunk that arrives early waits until all chunks
// before it are merged. So the merged result has the same bits for every order of arrival. The fold
// judges a tolerance when it merges a chunk. When the target is reached, the point is finished, and
// the fold drops every later chunk.
//
// A finished point can be continued: a fold of the same question with a larger target resumes from
// its continuation, and gives the same bits as if it had computed everything. Properties, each with
// a test of its name:
//   1. BlocksAndChunksInAnyOrderGiveTheSameBits.
//   2. AContinuedPointHasTheBitsOfOneLongRun.
// Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/ensemble/block_result.h"
#include "core/ensemble/chunk_fold.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston {

// The merged result, from which a point can be resumed.
struct FoldState {
  uint64_t chunk = 0;         // the first chunk that is not complete
  uint64_t blocks = 0;        // the number of merged blocks of that chunk
  BlockResult complete = {};  // the merged result of all complete chunks
  BlockResult partial = {};   // the merged blocks of that chunk
  // The smallest relative error of the first estimate at the ends of chunks before the last
  // complete one at which a tolerance is judged. A fold with this tolerance or a larger one may
  // have ended there.
  double least_error = std::numeric_limits<double>::infinity();
};

class PointFold {
 public:
  // The experiment must outlive the fold.
  explicit PointFold(const PointExperiment& experiment);

  // Takes a chunk. Drops a chunk that is not needed (Needs). Returns the number of samples that are
  // new in Merged().
  uint64_t Add(ChunkResult chunk);

  // Takes the first blocks of the first chunk that is not complete, for the result of an unfinished
  // point and for its checkpoint. Drops blocks of another chunk, and fewer blocks than it has.
  // Returns the number of samples that are new in Merged().
  uint64_t AddPartial(const PartialChunk& partial);

  // False if the chunk is merged or waits, or if the point is finished.
  bool Needs(uint64_t chunk) const;

  // Where this chunk starts, if samples continue each other. Empty in the first stage, and if its
  // group's previous chunk has not arrived.
  GroupState StartOf(uint64_t chunk) const;
  // Whether the chunk can be computed now: its start is known, or it needs none.
  bool CanStart(uint64_t chunk) const;

  // Ends the point with the merged result and drops waiting chunks.
  void Finish();

  // Continues from a state of the same experiment. Must be called before any chunk is added.
  void Resume(FoldState state);

  bool finished() const { return finished_; }
  const FoldState& state() const { return state_; }
  bool HasBlocks() const { return state_.chunk > 0 || state_.blocks > 0; }
  BlockResult Merged() const;       // the result of all merged chunks and blocks
  uint64_t PlannedSamples() const;  // of the merged blocks, including escaped orbits

  // Of a finished point: the state without what the end of its plan cut short. Empty if it is not
  // known.
  std::optional<FoldState> Continuation() const;
  size_t waiting() const { return early_.size(); }

 private:
  uint64_t MergeNext(const BlockResult& chunk);
  void JudgeLast();
  void KeepContinuation();
  bool ReachesTolerance() const;  // after the last complete chunk

  const PointExperiment& experiment_;
  const uint64_t chunks_;
  FoldState state_;
  bool finished_;
  std::map<uint64_t, BlockResult> early_;  // by chunk: those that wait for earlier ones
  PartialChunk whole_blocks_;              // of the chunk that is cut
  std::optional<FoldState> before_the_cut_;
};

// A whole point computed in one place: all its chunks, and their fold.
class LocalPoint : private BlockQueue {
 public:
  // The experiment must outlive this object.
  explicit LocalPoint(const PointExperiment& experiment, uint64_t window = ChunkFold::kWindow);

  // The next block to compute; empty if no block is left or the point is finished
  // (ChunkFold::NextBlock).
  std::optional<Block> NextBlock();
  void Add(const Block& block, BlockResult result);

  // Computes all blocks that are left on the calling thread.
  void Run();

  bool finished() const { return fold_.finished(); }
  // With the merged blocks of the first chunk that is not complete.
  FoldState State() const;
  BlockResult Merged() const;

 private:
  std::optional<Block> Next() override { return NextBlock(); }
  void Done(const Block& block, BlockResult result) override { Add(block, std::move(result)); }
  bool Pause() override { return finished(); }

  // The fold, with the merged blocks of the first chunk that is not complete.
  PointFold Now() const;

  const PointExperiment& experiment_;
  PointFold fold_;
  ChunkFold chunks_;
};

// Computes a whole point on the calling thread. Requires a target without a budget: nothing would
// end it.
BlockResult FoldPoint(const PointExperiment& experiment);

// Computes one block on the calling thread.
BlockResult RunBlock(const PointExperiment& experiment, const Block& block);

}  // namespace ballpiston
