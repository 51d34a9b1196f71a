// What a job's unfinished points were at one moment, made once for all who watch the job.
//
// To make one takes the scheduler's lock and copies what the points have merged, so a thousand
// watchers share one: what is young enough, or still true, is handed out again. Thread-safe.
#ifndef BALLPISTON_SERVER_JOBS_JOB_SNAPSHOT_H_
#define BALLPISTON_SERVER_JOBS_JOB_SNAPSHOT_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/functional/function_ref.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/result.pb.h"
#include "server/mutex.h"

namespace ballpiston::server {

struct JobSnapshot {
  struct Point {
    uint64_t change = 0;     // the number of its last
    v1::PointResult result;  // without histograms and curves
  };

  uint64_t change = 0;        // the job's last one before the snapshot was made
  int64_t finished = 0;       // the number of the last finished point then: none of `points` has it
                              // or a smaller one
  std::vector<Point> points;  // newest first
};

// Of a message about a job: a point that was finished after the unfinished ones were looked at is
// among the finished ones only.
void LeaveOutFinished(v1::StatisticsSnapshot& message);

class SharedSnapshot {
 public:
  using Make = absl::FunctionRef<JobSnapshot()>;

  // The last one, if nothing changed since (`change` is the job's last) or it is at most `max_age`
  // old; else a new one. `make` is called with a lock held, by one at a time.
  std::shared_ptr<const JobSnapshot> Get(uint64_t change, std::chrono::milliseconds max_age,
                                         Make make);

 private:
  using Clock = std::chrono::steady_clock;

  Mutex mutex_;
  std::shared_ptr<const JobSnapshot> last_ ABSL_GUARDED_BY(mutex_);
  Clock::time_point made_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_JOB_SNAPSHOT_H_
