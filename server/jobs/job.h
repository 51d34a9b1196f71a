// An active job: its state, its progress, and what changed when, for those who watch it.
//
// Every change has a number, counted from 1. A watcher remembers the number up to which it has told
// and asks for what is newer, so that a slow one misses what was overtaken and never the newest.
// Kept are the newest kRecentPoints finished points; all of them are in the store. Thread-safe.
#ifndef BALLPISTON_SERVER_JOBS_JOB_H_
#define BALLPISTON_SERVER_JOBS_JOB_H_

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/result.pb.h"
#include "server/store/job_record.h"

namespace ballpiston::server {

inline constexpr size_t kRecentPoints = 100;

class Job {
 public:
  using FinishedPoint = std::shared_ptr<const v1::PointResult>;  // without histograms

  struct Change {
    uint64_t number = 0;
    FinishedPoint point;
  };

  // `on_state_change` is called, without a lock, after each change of state.
  Job(JobRecord record, std::function<void()> on_state_change);

  int64_t sequence() const { return sequence_; }
  const std::string& id() const { return id_; }
  const std::string& principal() const { return principal_; }

  JobState state() const;
  v1::EnsembleJob Message() const;
  v1::JobProgress Progress() const;
  JobRecord Record() const;

  uint64_t last_change() const;
  uint64_t last_state_change() const;

  // False, and without effect, if `state` may not follow the present one.
  bool Enter(JobState state, absl::Time now, const std::string& error = std::string());

  // The following return the number of the change.

  // A block was merged: so many samples, that share of its point.
  uint64_t AddBlock(double samples, double share_of_point);
  void AddWork(double seconds);
  uint64_t AddFinishedPoint(FinishedPoint point);
  // Points that an earlier process finished; `recent` are some of them.
  uint64_t AddRestoredPoints(int64_t points, double samples, std::vector<FinishedPoint> recent);

  // Points finished after change `number`, newest first, at most `limit`.
  std::vector<Change> FinishedSince(uint64_t number, size_t limit) const;

 private:
  v1::JobProgress ProgressLocked() const;
  void RememberLocked(FinishedPoint point);

  const int64_t sequence_;
  const std::string id_;
  const std::string principal_;
  const bool open_ended_;  // how much there is to do is not known
  const std::function<void()> on_state_change_;

  mutable std::mutex mutex_;
  JobRecord record_;
  double work_done_ = 0;  // in points
  uint64_t last_change_ = 1;
  uint64_t last_state_change_ = 1;
  std::deque<Change> recent_;  // newest first
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_JOB_H_
