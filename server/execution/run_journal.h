// The interface through which a run reports its progress (merged blocks, finished points, the end)
// and reads the checkpoints of an earlier process.
//
// One journal belongs to one run. The pool's threads call it, so an implementation must be
// thread-safe. Calls about one point come in order. PointFinished comes after the point's last
// Merged. Ended is the last call and comes once, or never if the pool shuts down first.
#ifndef BALLPISTON_SERVER_EXECUTION_RUN_JOURNAL_H_
#define BALLPISTON_SERVER_EXECUTION_RUN_JOURNAL_H_

#include <cstddef>
#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"

namespace ballpiston::server {

class RunJournal {
 public:
  struct MergedSamples {
    size_t point = 0;
    uint64_t samples = 0;
    double share_of_point = 0;  // of the point's planned samples
    bool restored = false;      // an earlier process computed them
  };

  virtual ~RunJournal() = default;

  // A worker is about to begin the run's first task.
  virtual void Began() = 0;

  // The checkpoint of an unfinished point from an earlier process; empty if there is none.
  virtual absl::StatusOr<std::optional<FoldState>> ReadCheckpoint(size_t point) = 0;

  // Returns the number of this change in the run's history. The pool holds its lock during this and
  // the next call, so both must be quick, must not wait and must not call the pool.
  virtual uint64_t Merged(const MergedSamples& merged) = 0;

  // Called from time to time with the state of an unfinished point.
  virtual void Checkpoint(size_t point, const FoldState& state) = 0;

  // Seconds of processor time that a worker has just spent on the run.
  virtual void Worked(double seconds) = 0;

  // May be slow.
  virtual void PointFinished(size_t point, const PointExperiment& experiment,
                             const BlockResult& merged) = 0;

  // OK: every point is finished. CANCELLED: the run was stopped. Otherwise the reason of failure.
  virtual void Ended(const absl::Status& outcome) = 0;

  // A worker calls this between two turns. It returns when the journal has room for more reports.
  virtual void AwaitRoom() = 0;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_RUN_JOURNAL_H_
