#include "server/jobs/acceptance.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"
#include "server/store/job_table.h"
#include "server/store/sweeper.h"

namespace ballpiston::server {
namespace {

bool Exceeds(double value, double limit) { return limit > 0 && value > limit; }

// These set `refused` to the reason why one more job of the principal is not accepted, if there is
// one. They return the errors of the store.

absl::Status CheckQueue(Database& database, const Limits& limits, const JobRecord& job,
                        absl::Status& refused) {
  const absl::StatusOr<Load> all = ActiveLoad(database, std::nullopt);
  if (!all.ok()) return all.status();
  const absl::StatusOr<Load> own = ActiveLoad(database, job.principal);
  if (!own.ok()) return own.status();
  const std::string& principal = job.principal;
  const auto check = [&](int64_t with_job, int64_t most, const char* reason, const char* flag,
                         const std::string& what) {
    if (most == 0 || with_job <= most) return;
    refused.Update(LimitExceeded(reason, what, flag, static_cast<double>(most)));
  };
  check(all->jobs + 1, limits.max_active_jobs, "QUEUE_FULL", "max-active-jobs",
        absl::StrCat(all->jobs, " jobs are active"));
  check(own->jobs + 1, limits.max_active_jobs_per_principal, "TOO_MANY_JOBS",
        "max-active-jobs-per-principal",
        absl::StrCat(principal, " has ", own->jobs, " active jobs already"));
  const int64_t all_points = all->points + job.points, own_points = own->points + job.points;
  check(all_points, limits.max_active_points, "TOO_MANY_ACTIVE_POINTS", "max-active-points",
        absl::StrCat("active jobs would have ", all_points, " points with this one"));
  check(own_points, limits.max_active_points_per_principal, "TOO_MANY_ACTIVE_POINTS",
        "max-active-points-per-principal",
        absl::StrCat(principal, "'s active jobs would have ", own_points, " points with this one"));
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

absl::Status CheckRoom(Database& database, const Limits& limits, const JobRecord& job,
                       absl::Status& refused) {
  const absl::Status counted = CheckQueue(database, limits, job, refused);
  return counted.ok() && refused.ok() ? CheckStoreSize(database, limits, refused) : counted;
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

absl::Status Judge(Database& database, const Limits& limits, Acceptance& acceptance) {
  acceptance.earlier.reset();
  acceptance.replay = acceptance.answered_from_store = false;
  acceptance.refused = absl::OkStatus();
  const absl::Status looked = FindEarlier(database, acceptance);
  if (!looked.ok() || acceptance.earlier || !acceptance.refused.ok()) return looked;
  acceptance.refused = acceptance.fits;
  if (!acceptance.refused.ok()) return absl::OkStatus();
  return CheckRoom(database, limits, acceptance.record, acceptance.refused);
}

absl::Status Accept(Database& database, const Limits& limits, Acceptance& acceptance) {
  const absl::Status judged = Judge(database, limits, acceptance);
  if (!judged.ok() || !acceptance.refused.ok()) return judged;
  if (acceptance.earlier) return KeepRequest(database, acceptance, acceptance.earlier->sequence);
  const absl::Status made = InsertJob(database, acceptance.record);
  return made.ok() ? KeepRequest(database, acceptance, acceptance.record.sequence) : made;
}

}  // namespace ballpiston::server
