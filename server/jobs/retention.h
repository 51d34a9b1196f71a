// How long results are kept: Limits::retain_days and Limits::max_store_bytes.
//
// The results of a job that is not pinned expire `retain_days` after its end. If the store takes
// more than kFullShare of its bound, results expire earlier, those of the jobs that ended first;
// when none are left, expired jobs are deleted in the same order. The data of active and pinned
// jobs are never removed here, so the store may grow beyond the bound; then no new job is accepted
// (acceptance.h).
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/limits.h"
#include "server/store/job_table.h"
#include "server/store/store.h"

namespace ballpiston::server {

// Space is freed before the bound is reached, so that new jobs need not be refused meanwhile.
inline constexpr double kFullShare = 0.95;

class Retention {
 public:
  // The store has to outlive this.
  Retention(Store& store, const Limits& limits) : store_(store), limits_(limits) {}

  // Lets results expire and deletes expired jobs, as the limits require at the time `now`. One call
  // handles at most a few hundred jobs, so it is to be called again and again.
  absl::Status Enforce(absl::Time now);

 private:
  enum class Removal { kResults, kJob };

  absl::Status EnforceAge(absl::Time now);
  absl::Status EnforceSize(absl::Time now);
  absl::Status Remove(const std::vector<JobSize>& jobs, Removal removal, absl::Time now);

  Store& store_;
  const Limits limits_;
};

}  // namespace ballpiston::server
