// Decides the outcome of one Create: an earlier job, an error, or a new job.
//
// A retry (the same request id with the same request) returns the original job. If the principal
// asks the question of an earlier job that succeeded, the server returns that job unless `fresh` is
// set or its labels do not fit the request's: a label has another value in both, or together they
// are too many. Any other request must be one that this machine can compute, and must keep the
// limits: on a job's size, on active jobs and their points, and on the size of the store. All this
// is decided inside one transaction of the store. The store runs its transactions one after the
// other, so many equal requests at the same time make one job.
//
// A new job continues an earlier one that SUCCEEDED in answering the same question with no more
// samples or a larger tolerance: each point begins where that job's point ended, if the
// same model answers it. So the job computes only the difference, and its result has the bytes of
// one long run. If that job is deleted meanwhile, the points begin anew. If another machine
// computed a point's last chunk, the part of it that the target cut short is computed again.
//
// If an earlier job is returned, also for a retry, the request's labels are added to its labels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ballpiston/v1/ensemble.pb.h"
#include "server/convert/errors.h"
#include "server/limits.h"
#include "server/store/job_record.h"
#include "server/store/job_table.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

struct Acceptance {
  JobRecord record;    // the new job, with the id and the hash of its request
  bool fresh = false;  // do not return an earlier job
  // The samples of all points for which the target asks, rounded up as the points' plans do; 0 with
  // a tolerance, a budget, or a model without samples.
  double samples = 0;
  std::vector<FieldViolation> violations;  // what this machine cannot do
  int64_t active_bytes = 0;  // of all active jobs; not set without a bound of the store
};

// Returns the earlier job that answers the request. answered_from_store is true if the job answers
// the same question, false if the request is a retry. Empty: the new job is stored, and its record
// names the job that it continues.
// If the request is refused, the transaction fails: INVALID_ARGUMENT or RESOURCE_EXHAUSTED.
std::optional<JobRecord> Accept(Database& database, const Limits& limits, Acceptance& acceptance);

// A hash of everything that determines the answer: the whole specification with its seed, and the
// engine's version. Empty if the job has a budget, because the answer then depends on the machine.
std::string QuestionOf(const v1::EnsembleSpec& spec, const std::string& engine_version);

// The same without the target's number of samples, collisions or tolerance. Empty with a budget.
std::string FamilyOf(const v1::EnsembleSpec& spec, const std::string& engine_version);

// A hash of the whole request except its id and its labels.
std::string PayloadOf(const v1::CreateEnsembleJobRequest& request);

}  // namespace ballpiston::server
