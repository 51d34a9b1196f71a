// How many points the grids of all active jobs have together: what bounds the memory of those that
// wait, some 25 bytes a point. (SQL could add them up, but would read every specification to do
// so.) Thread-safe.
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
  // Whether there is room for so many more. RESOURCE_EXHAUSTED  TOO_MANY_ACTIVE_POINTS
  absl::Status Check(const std::string& principal, int64_t points, const Limits& limits) const;

  // Counts those of a job, once.
  void Add(const std::string& job, const std::string& principal, int64_t points);
  // Without effect if they are not counted.
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
