// What one Create comes to: an earlier job, a refusal, or a new job.
//
// A retry (the same request id with the same request) is answered with the original job. The
// question of an earlier job that succeeded is answered with that job, unless a fresh answer is
// wanted. Any other request has to keep the limits: on a job's size, on active jobs and their
// points, on what is stored and on processor time. All of this is decided inside one transaction of
// the store. The store runs its transactions one after the other, so of many equal requests at the
// same time only one makes a job.
#ifndef BALLPISTON_SERVER_JOBS_ACCEPTANCE_H_
#define BALLPISTON_SERVER_JOBS_ACCEPTANCE_H_

#include <optional>

#include "absl/status/status.h"
#include "core/ensemble/ensemble_spec.h"
#include "server/jobs/active_points.h"
#include "server/jobs/usage.h"
#include "server/limits.h"
#include "server/store/job_record.h"
#include "server/store/request_table.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

struct Acceptance {
  JobRecord record;       // the job that would be made
  RequestRecord request;  // without an id: nothing is kept of it
  bool fresh = false;     // an earlier answer will not do
  absl::Status fits;      // CheckSize, which counts for new jobs only

  // The outcome; if nothing is earlier and nothing refused, there is to be a new job.
  std::optional<JobRecord> earlier;
  bool replay = false;               // `earlier` is what the same request came to before
  bool answered_from_store = false;  // by `earlier`, now or the first time
  absl::Status refused;              // INVALID_ARGUMENT or RESOURCE_EXHAUSTED
};

// Each sets the outcome anew; Accept then writes what it comes to, and counts the points of a new
// job: whoever commits takes them back if that fails. Not OK: SQLite failed.
absl::Status Judge(Database& database, const Limits& limits, const ActivePoints& points,
                   const Usage& usage, Acceptance& acceptance);
absl::Status Accept(Database& database, const Limits& limits, ActivePoints& points,
                    const Usage& usage, Acceptance& acceptance);

// RESOURCE_EXHAUSTED  TOO_MANY_POINTS, TOO_MANY_SAMPLES
absl::Status CheckSize(const EnsembleSpec& spec, const Limits& limits);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_ACCEPTANCE_H_
