// What a run tells the world outside: which blocks were merged, which points are finished, how it
// ended; and what it asks of it: the blocks computed before a restart.
//
// One journal belongs to one run. Called from the pool's threads; an implementation has to be
// thread-safe. Calls about one point come in order; PointFinished comes after its last BlockMerged;
// Ended is the last call of all, and comes once (not at all if the pool is shut down first).
#ifndef BALLPISTON_SERVER_EXECUTION_RUN_JOURNAL_H_
#define BALLPISTON_SERVER_EXECUTION_RUN_JOURNAL_H_

#include <cstddef>
#include <cstdint>
#include <functional>

#include "absl/status/status.h"
#include "core/experiment/block_result.h"
#include "core/experiment/point_experiment.h"

namespace ballpiston::server {

class RunJournal {
 public:
  using OnStoredBlock = std::function<void(uint64_t block, BlockResult result)>;

  struct MergedBlock {
    size_t point = 0;
    uint64_t block = 0;
    double share_of_point = 0;  // of the point's planned samples
    bool restored = false;      // was in the store already
    BlockResult& result;        // may be moved
  };

  virtual ~RunJournal() = default;

  // The first block of the run is about to be computed.
  virtual void Began() = 0;

  // The blocks of an unfinished point that an earlier process left behind, in order.
  virtual absl::Status ReadStoredBlocks(size_t point, const OnStoredBlock& on_block) = 0;

  // Returns the number of this change in the run's history. The pool's lock is held: quick, no
  // waiting, no calls into the pool.
  virtual uint64_t BlockMerged(MergedBlock block) = 0;

  // Seconds of processor time that a worker has just spent on the run.
  virtual void Worked(double seconds) = 0;

  // May take its time.
  virtual void PointFinished(size_t point, const PointExperiment& experiment,
                             const BlockResult& merged) = 0;

  // OK: every point is finished. CANCELLED: it was told to stop. Else the reason of its failure.
  virtual void Ended(const absl::Status& outcome) = 0;

  // Called by a worker between two blocks: returns when what was reported is taken care of.
  virtual void AwaitRoom() = 0;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_RUN_JOURNAL_H_
