// A copy of a job's unfinished points at one moment, shared by all watches of the job.
//
// Making a snapshot takes the scheduler's lock and copies the merged results of the points. So all
// watches get the same snapshot as long as it is recent enough or nothing has changed. Thread-safe.
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
    uint64_t change = 0;     // the number of its last change
    v1::PointResult result;  // without histograms and curves
  };

  uint64_t change = 0;        // the job's last change before the snapshot
  int64_t finished = 0;       // the number of the last finished point then: none of `points` has it
                              // or a smaller one
  std::vector<Point> points;  // newest first
};

// Removes those points from the unfinished ones of a message that are also among its finished ones:
// they were finished after the snapshot was made.
void LeaveOutFinished(v1::StatisticsSnapshot& message);

class SharedSnapshot {
 public:
  using Make = absl::FunctionRef<JobSnapshot()>;

  // Returns the last snapshot if nothing has changed since (`change` is the job's last change), or
  // if it is at most `max_age` old. Otherwise makes a new snapshot: calls `make` with a lock held,
  // in one thread at a time.
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
