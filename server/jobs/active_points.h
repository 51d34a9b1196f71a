// Counts the grid points of all active jobs. Their limit bounds the memory of waiting jobs, some 25
// bytes a point. (To count them with SQL, the store would have to read every specification.)
// Thread-safe.
#ifndef BALLPISTON_SERVER_JOBS_ACTIVE_POINTS_H_
#define BALLPISTON_SERVER_JOBS_ACTIVE_POINTS_H_

#include <cstdint>
#include <map>
#include <string>

#include "absl/status/status.h"
#include "server/limits.h"
#include "server/mutex.h"

namespace ballpiston::server {

class ActivePoints {
 public:
  // Whether this many more points keep the limits. RESOURCE_EXHAUSTED, TOO_MANY_ACTIVE_POINTS if
  // not.
  absl::Status Check(const std::string& principal, int64_t points, const Limits& limits) const;

  // Counts the points of a job. A second call for the same job has no effect.
  void Add(const std::string& job, const std::string& principal, int64_t points);
  // No effect if the job is not counted.
  void Remove(const std::string& job);

 private:
  struct Grid {
    std::string principal;
    int64_t points = 0;
  };

  mutable Mutex mutex_;
  std::map<std::string, Grid> grids_ ABSL_GUARDED_BY(mutex_);  // by job
  std::map<std::string, int64_t> of_principals_ ABSL_GUARDED_BY(mutex_);
  int64_t all_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_ACTIVE_POINTS_H_
