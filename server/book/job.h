// What memory knows about an active job: its progress, and numbered changes that wake watches.
//
// The job's row owns everything that is stored, above all the state (store/job_record.h). Memory
// owns what is not stored yet: the numbers of the points that are being computed. JobBook::Message
// combines both into the job that clients see.
//
// Changes are numbered from 1. A watch remembers the number of the last change that it has sent and
// asks for newer ones. So a slow watch may skip intermediate states, but always gets the newest.
//
// Finished points have numbers of their own. The store assigns them, and they stay valid after a
// restart of the server (point_tables.h). A point counts as done, and can be sent, when it is
// stored. Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/functional/function_ref.h"
#include "ballpiston/v1/result.pb.h"
#include "server/mutex.h"
#include "server/store/job_record.h"
#include "server/store/point_tables.h"

namespace ballpiston::server {

// The job's unfinished points at one moment.
struct JobSnapshot {
  struct Point {
    uint64_t change = 0;     // the number of its last change
    v1::PointResult result;  // without histograms and curves
  };

  uint64_t change = 0;        // the job's last change before the snapshot
  int64_t finished = 0;       // the number of the last finished point then: none of `points` has it
                              // or a smaller one
  std::vector<Point> points;  // newest first
};

class Job {
 public:
  explicit Job(JobRecord row);

  // The row when the job became active, without its specification.
  const JobRecord& row() const { return row_; }

  JobNumbers Numbers() const;

  // These three take no lock, because a thousand watches call them several times a second.
  uint64_t last_change() const { return last_change_; }
  uint64_t last_state_change() const { return last_state_change_; }
  int64_t last_finished() const { return last_finished_; }  // the number of that point

  // Call when a change of the row's state is committed.
  void NoteStateChange();
  // Waits for a change of state after number `after`, at most until the time `until`.
  void AwaitStateChange(uint64_t after, std::chrono::steady_clock::time_point until);
  // Ends all waits, now and later. Call it when the server stops.
  void StopWaiting();

  // Adds what was computed, or restored from a checkpoint. Returns the number of the change.
  uint64_t Add(const JobNumbers& more);
  // Adds a point that is stored now, with this number. Call in the order of the numbers.
  void AddFinishedPoint(int64_t number);
  // Adds the points that an earlier process stored. Call before AddFinishedPoint.
  void AddRestoredPoints(const std::vector<PointSize>& points);

  // All watches of the job share this snapshot, because making one takes the scheduler's lock.
  // Returns the last one if nothing has changed since it was made, or if it is younger than
  // `max_age`. Otherwise calls `make`, in one thread at a time.
  std::shared_ptr<const JobSnapshot> Snapshot(std::chrono::milliseconds max_age,
                                              absl::FunctionRef<JobSnapshot()> make);

 private:
  const JobRecord row_;

  mutable Mutex mutex_;
  Condition state_changed_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  JobNumbers numbers_ ABSL_GUARDED_BY(mutex_);
  std::atomic<uint64_t> last_change_ = 1;
  std::atomic<uint64_t> last_state_change_ = 1;
  std::atomic<int64_t> last_finished_ = 0;

  Mutex snapshot_mutex_;
  std::shared_ptr<const JobSnapshot> snapshot_ ABSL_GUARDED_BY(snapshot_mutex_);
  std::chrono::steady_clock::time_point snapshot_time_ ABSL_GUARDED_BY(snapshot_mutex_);
};

}  // namespace ballpiston::server
