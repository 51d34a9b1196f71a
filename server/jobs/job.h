// An active job: its state, its progress, and its numbered changes, for watches.
//
// Changes are numbered from 1. A watch remembers the number of the last change that it has sent and
// asks for newer ones. So a slow watch may skip intermediate states, but always gets the newest.
//
// Finished points have numbers of their own. The store assigns them, and they stay valid after a
// restart of the server (point_tables.h). A point counts as done, and can be sent, when it is
// stored. The job keeps the newest kRecentPoints in memory; the store has all of them. Thread-safe.
#ifndef BALLPISTON_SERVER_JOBS_JOB_H_
#define BALLPISTON_SERVER_JOBS_JOB_H_

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ballpiston/v1/ensemble.pb.h"
#include "server/jobs/job_snapshot.h"
#include "server/mutex.h"
#include "server/store/job_record.h"

namespace ballpiston::server {

inline constexpr size_t kRecentPoints = 100;

struct FinishedPoint {
  int64_t number = 0;
  std::shared_ptr<const std::string> result;  // serialized storage::Result
};

class Job {
 public:
  // The job at one moment.
  struct View {
    v1::EnsembleJob job;
    uint64_t state_change = 0;  // the number of its last change of state
  };

  // `on_state_change` is called, without a lock, after each change of state.
  Job(JobRecord record, std::function<void()> on_state_change);

  int64_t sequence() const { return sequence_; }
  const std::string& id() const { return id_; }
  const std::string& principal() const { return principal_; }
  int64_t restarts() const { return restarts_; }

  JobState state() const;
  View Now() const;
  v1::JobProgress Progress() const;
  JobRecord Record() const;  // without the specification, which may be large
  size_t spec_bytes() const { return spec_.size(); }

  // These three take no lock, because a thousand watches call them several times a second.
  uint64_t last_change() const { return last_change_; }
  uint64_t last_state_change() const { return last_state_change_; }
  int64_t last_finished() const { return last_finished_; }  // the number of that point

  // False, and no effect, if `state` cannot follow the present state.
  bool Enter(JobState state, absl::Time now, const std::string& error = std::string());

  // Adds the samples of merged blocks or of a restored checkpoint, and their share of the point.
  // Returns the number of the change.
  uint64_t AddSamples(double samples, double share_of_point);
  void AddWork(double seconds);
  void AddBytes(int64_t bytes);  // of results
  void SetPinned(bool pinned);
  // Adds a point that is stored now. Call in the order of the points' numbers.
  void AddFinishedPoint(FinishedPoint point);
  // Adds points that an earlier process stored; `last` is the number of the last one. Call before
  // AddFinishedPoint.
  void AddRestoredPoints(int64_t points, double samples, int64_t last);

  // The finished points after number `after`, oldest first, at most `limit`. Empty if some of these
  // points are no longer in memory.
  std::optional<std::vector<FinishedPoint>> FinishedAfter(int64_t after, size_t limit) const;

  SharedSnapshot& snapshot() { return snapshot_; }

 private:
  v1::JobProgress ProgressLocked() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const int64_t sequence_;
  const std::string id_;
  const std::string principal_;
  const int64_t restarts_;
  const std::string spec_;  // serialized
  const bool open_ended_;   // the number of samples is not known in advance
  const std::function<void()> on_state_change_;

  mutable Mutex mutex_;
  JobRecord record_ ABSL_GUARDED_BY(mutex_);      // without the specification
  double work_done_ ABSL_GUARDED_BY(mutex_) = 0;  // in points
  std::atomic<uint64_t> last_change_ = 1;
  std::atomic<uint64_t> last_state_change_ = 1;
  std::atomic<int64_t> last_finished_ = 0;
  std::deque<FinishedPoint> recent_ ABSL_GUARDED_BY(mutex_);  // oldest first
  // The number of the last point before those in recent_.
  int64_t last_forgotten_ ABSL_GUARDED_BY(mutex_) = 0;

  SharedSnapshot snapshot_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_JOB_H_
