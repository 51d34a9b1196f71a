#include "server/jobs/acceptance.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"
#include "server/store/job_table.h"
#include "server/store/usage_table.h"

namespace ballpiston::server {
namespace {

bool Exceeds(double value, double limit) { return limit > 0 && value > limit; }

// These set `refused` to the reason why one more job of the principal is not accepted, if there is
// one. They return the errors of the store.

absl::Status CheckQueue(Database& database, const Limits& limits, const std::string& principal,
                        absl::Status& refused) {
  const auto all = CountActiveJobs(database, std::nullopt);
  if (!all.ok()) return all.status();
  const auto own = CountActiveJobs(database, principal);
  if (!own.ok()) return own.status();
  if (limits.max_active_jobs > 0 && *all >= limits.max_active_jobs) {
    refused = LimitExceeded("QUEUE_FULL", absl::StrCat(*all, " jobs are active"), "max-active-jobs",
                            static_cast<double>(limits.max_active_jobs));
  } else if (limits.max_active_jobs_per_principal > 0 &&
             *own >= limits.max_active_jobs_per_principal) {
    refused = LimitExceeded(
        "TOO_MANY_JOBS", absl::StrCat(principal, " has ", *own, " active jobs already"),
        "max-active-jobs-per-principal", static_cast<double>(limits.max_active_jobs_per_principal));
  }
  return absl::OkStatus();
}

// Results expire before the store is full, but those of pinned and active jobs do not.
absl::Status CheckStoreSize(Database& database, const Limits& limits, absl::Status& refused) {
  if (limits.max_store_bytes == 0) return absl::OkStatus();
  const absl::StatusOr<int64_t> used = UsedBytes(database);
  if (!used.ok()) return used.status();
  if (*used <= limits.max_store_bytes) return absl::OkStatus();
  refused =
      LimitExceeded("TOO_MANY_STORED_BYTES",
                    absl::StrCat("the store holds ", *used, " bytes: unpin or delete some jobs"),
                    "max-store-bytes", static_cast<double>(limits.max_store_bytes));
  return absl::OkStatus();
}

absl::Status CheckRoom(Database& database, const Limits& limits, const ActivePoints& points,
                       const Usage& usage, const JobRecord& job, absl::Status& refused) {
  const absl::Status counted = CheckQueue(database, limits, job.principal, refused);
  if (!counted.ok()) return counted;
  refused.Update(points.Check(job.principal, job.points, limits));
  refused.Update(usage.Check(job.principal, job.create_time, limits));
  return refused.ok() ? CheckStoreSize(database, limits, refused) : absl::OkStatus();
}

// A job has at most this many stored requests. Later ones that it answers are not stored.
constexpr int64_t kMostRequestsOfJob = 1000;

// A retry of a request that is not stored returns the same job, because the job is stored.
absl::StatusOr<bool> IsWorthKeeping(Database& database, const Acceptance& acceptance, int64_t job) {
  if (acceptance.request.request_id.empty() || acceptance.replay) return false;
  if (!acceptance.answered_from_store) return true;
  const auto kept = CountRequests(database, job, kMostRequestsOfJob);
  if (!kept.ok()) return kept.status();
  return *kept < kMostRequestsOfJob;
}

absl::Status KeepRequest(Database& database, Acceptance& acceptance, int64_t job) {
  const absl::StatusOr<bool> kept = IsWorthKeeping(database, acceptance, job);
  if (!kept.ok() || !*kept) return kept.status();
  acceptance.request.job = job;
  acceptance.request.answered_from_store = acceptance.answered_from_store;
  return InsertRequest(database, acceptance.request);
}

absl::Status Replay(Database& database, const RequestRecord& request, Acceptance& acceptance) {
  auto job = FindJobBySequence(database, request.job, Grid::kIncluded);
  if (!job.ok()) return job.status();
  acceptance.earlier = *std::move(job);
  acceptance.replay = true;
  acceptance.answered_from_store = request.answered_from_store;
  if (request.payload != acceptance.request.payload) {
    acceptance.refused = RequestIdReused(request.request_id);
  }
  return absl::OkStatus();
}

absl::Status FindEarlier(Database& database, Acceptance& acceptance) {
  const std::string& principal = acceptance.record.principal;
  if (!acceptance.request.request_id.empty()) {
    const auto request = FindRequest(database, principal, acceptance.request.request_id);
    if (!request.ok()) return request.status();
    if (*request) return Replay(database, **request, acceptance);
  }
  if (acceptance.fresh) return absl::OkStatus();
  auto answer = FindAnswer(database, principal, acceptance.record.question);
  if (!answer.ok()) return answer.status();
  acceptance.earlier = *std::move(answer);
  acceptance.answered_from_store = acceptance.earlier.has_value();
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckSize(const EnsembleSpec& spec, const Limits& limits) {
  const double points = static_cast<double>(PointCount(spec));
  if (Exceeds(points, static_cast<double>(limits.max_points_per_job))) {
    return LimitExceeded("TOO_MANY_POINTS", absl::StrCat("the grid has ", points, " points"),
                         "max-points-per-job", static_cast<double>(limits.max_points_per_job));
  }
  const Target& target = spec.target;
  const bool open_ended = target.tolerance || target.budget_seconds;
  const int64_t of_a_point =
      target.samples.value_or(target.collisions.value_or(open_ended ? 0 : kDefaultSamples));
  const double samples = points * static_cast<double>(of_a_point);
  if (!Exceeds(samples, limits.max_samples_per_job)) return absl::OkStatus();
  return LimitExceeded("TOO_MANY_SAMPLES", absl::StrCat("the job takes ", samples, " samples"),
                       "max-samples-per-job", limits.max_samples_per_job);
}

absl::Status Judge(Database& database, const Limits& limits, const ActivePoints& points,
                   const Usage& usage, Acceptance& acceptance) {
  acceptance.earlier.reset();
  acceptance.replay = acceptance.answered_from_store = false;
  acceptance.refused = absl::OkStatus();
  const absl::Status looked = FindEarlier(database, acceptance);
  if (!looked.ok() || acceptance.earlier || !acceptance.refused.ok()) return looked;
  acceptance.refused = acceptance.fits;
  if (!acceptance.refused.ok()) return absl::OkStatus();
  return CheckRoom(database, limits, points, usage, acceptance.record, acceptance.refused);
}

absl::Status Accept(Database& database, const Limits& limits, ActivePoints& points,
                    const Usage& usage, Acceptance& acceptance) {
  const JobRecord& record = acceptance.record;
  points.Remove(record.id);  // of a transaction that was rolled back
  const absl::Status judged = Judge(database, limits, points, usage, acceptance);
  if (!judged.ok() || !acceptance.refused.ok()) return judged;
  if (acceptance.earlier) return KeepRequest(database, acceptance, acceptance.earlier->sequence);
  points.Add(record.id, record.principal, record.points);
  absl::Status made = InsertJob(database, acceptance.record);
  if (made.ok()) made = KeepRequest(database, acceptance, acceptance.record.sequence);
  if (!made.ok()) points.Remove(record.id);
  return made;
}

}  // namespace ballpiston::server
