// Counts the stored jobs, their bytes and the processor time of each principal, and checks them
// against the quotas. The counts are in memory, because the store would have to add up all its jobs
// for every new job. Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/limits.h"
#include "server/mutex.h"
#include "server/store/usage_table.h"

namespace ballpiston::server {

struct PrincipalUsage {
  int64_t jobs = 0;
  int64_t bytes = 0;   // of their specifications and results
  double seconds = 0;  // of processor time in the last kQuotaDays
};

class Usage {
 public:
  // Jobs and bytes that are stored. The numbers are negative for those that are removed.
  void AddStored(const std::string& principal, int64_t jobs, int64_t bytes);
  void AddWork(const std::string& principal, absl::Time now, double seconds);
  // What an earlier process stored.
  void AddStoredWork(const DayOfWork& work);

  // RESOURCE_EXHAUSTED  TOO_MANY_STORED_BYTES, TOO_MANY_SECONDS: no new job is accepted
  absl::Status Check(const std::string& principal, absl::Time now, const Limits& limits) const;

  PrincipalUsage Of(const std::string& principal, absl::Time now) const;
  // All principals that use anything.
  std::map<std::string, PrincipalUsage> All(absl::Time now) const;

  // The work that was added since the previous call. The caller stores it. Forgets the days that do
  // not count any more at the time `now`.
  std::vector<DayOfWork> TakeNewWork(absl::Time now);

  // The first of the days that count.
  static int64_t FirstDay(absl::Time now);

 private:
  using Day = std::pair<std::string, int64_t>;  // principal, day

  PrincipalUsage Locked(const std::string& principal, absl::Time now) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  mutable Mutex mutex_;
  std::map<std::string, PrincipalUsage> stored_ ABSL_GUARDED_BY(mutex_);  // without the seconds
  std::map<Day, double> work_ ABSL_GUARDED_BY(mutex_);
  std::map<Day, double> new_work_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
