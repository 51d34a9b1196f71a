// How long results are kept: Limits::retain_days and Limits::max_store_bytes.
//
// The results of a job that is not pinned expire `retain_days` after its end. If the store takes
// more than kFullShare of its bound, results expire earlier, beginning with the job that ended
// first. If no results are left that can expire, the expired jobs are deleted in the same order.
// The data of active and pinned jobs are never removed here, so the store may grow beyond the
// bound; then no new job is accepted (acceptance.h).
#pragma once

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/limits.h"
#include "server/store/store.h"

namespace ballpiston::server {

// Space is freed before the bound is reached, so that new jobs need not be refused meanwhile.
inline constexpr double kFullShare = 0.95;

// Lets results expire and deletes expired jobs, as the limits require at the time `now`. One call
// handles at most a few hundred jobs, so it is to be called again and again.
absl::Status EnforceRetention(Store& store, const Limits& limits, absl::Time now);

}  // namespace ballpiston::server
