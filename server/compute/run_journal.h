// The interface through which a run reports its progress (merged blocks, finished points, the end)
// and reads the checkpoints of an earlier process.
//
// One journal belongs to one run. Threads of executors call it, so an implementation must be
// thread-safe. Calls about one point come in order. PointFinished comes after the point's last
// Merged. Ended is the last call and comes once, or never if the scheduler shuts down first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "server/convert/fold_record.h"

namespace ballpiston::server {

struct StoredPoint {
  std::optional<StoredState> state;      // empty: there is no checkpoint
  std::vector<StoredChunk> chunks = {};  // that arrived early
  // If there is no checkpoint: where the point of an earlier job ended, which asked the same
  // question with another target.
  std::optional<StoredState> earlier = {};
};

class RunJournal {
 public:
  struct MergedSamples {
    size_t point = 0;
    uint64_t samples = 0;
    double share_of_point = 0;  // of the point's planned samples
    bool restored = false;      // an earlier process computed them
  };

  virtual ~RunJournal() = default;

  // The run's first turn begins.
  virtual void Began() = 0;

  // Returns what an earlier process stored of an unfinished point, or what an earlier job stored of
  // the same point. UNAVAILABLE if the disk cannot be read; this call has then waited, and the
  // caller can repeat it at once.
  virtual absl::StatusOr<StoredPoint> ReadPoint(size_t point) = 0;

  // The scheduler holds its lock during this call and the next three, so they must be quick, must
  // not wait and must not call the scheduler. Returns the number of this change in the run's
  // history.
  virtual uint64_t Merged(const MergedSamples& merged) = 0;

  // Called from time to time with the state of an unfinished point and the model that computed it.
  // Chunks before state.chunk that arrived early are part of the state.
  virtual void Checkpoint(size_t point, Model model, const FoldState& state) = 0;

  // A chunk that waits for an earlier one.
  virtual void ChunkIsEarly(size_t point, Model model, const ChunkResult& chunk) = 0;

  // Seconds of processor time that an executor has just spent on the run.
  virtual void Worked(double seconds) = 0;

  // May be slow. `fold` is finished.
  virtual void PointFinished(size_t point, const PointExperiment& experiment,
                             const PointFold& fold) = 0;

  // OK: every point is finished. CANCELLED: the run was stopped. Otherwise the reason of failure.
  virtual void Ended(const absl::Status& outcome) = 0;

  // Called after a turn with results. Waits until the journal has room for more reports. Returns
  // the seconds of the wait.
  virtual double AwaitRoom() = 0;
};

}  // namespace ballpiston::server
