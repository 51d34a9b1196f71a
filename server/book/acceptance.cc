#include "server/book/acceptance.h"

#include "absl/strings/str_cat.h"
#include "server/convert/spec.h"
#include "server/sha256.h"

namespace ballpiston::server {
namespace {

constexpr char kWait[] = "wait until some jobs have ended, or cancel some of yours";

// Refuses the job if it, or its principal's active jobs together, would exceed a limit.
void CheckLoad(Database& database, const Limits& limits, const v1::EnsembleJob& job) {
  const std::string& principal = job.principal();
  const Load load = ActiveLoad(database, principal);
  const int64_t points = job.progress().points();
  const auto check = [&](int64_t with_job, int64_t most, const char* reason, const char* flag,
                         const std::string& what) {
    if (most == 0 || with_job <= most) return;
    database.Fail(LimitExceeded(reason, what, flag, static_cast<double>(most)));
  };
  check(points, limits.max_points_per_job, "TOO_MANY_POINTS", "max-points-per-job",
        absl::StrCat("the grid has ", points, " points: split it between several jobs"));
  check(load.jobs + 1, limits.max_active_jobs_per_principal, "TOO_MANY_JOBS",
        "max-active-jobs-per-principal",
        absl::StrCat(principal, " has ", load.jobs, " active jobs already: ", kWait));
  const int64_t active = load.points + points;
  check(active, limits.max_active_points_per_principal, "TOO_MANY_ACTIVE_POINTS",
        "max-active-points-per-principal",
        absl::StrCat(principal, "'s active jobs would have ", active,
                     " points with this one: ", kWait));
}

// Refuses the job if pinned and active jobs alone, without their checkpoints, exceed the limit. All
// other jobs are removed when the store is full (retention.cc).
void CheckStoreSize(Database& database, const Limits& limits, int64_t active_bytes) {
  if (limits.max_store_bytes == 0) return;
  const int64_t kept = active_bytes + PinnedBytesOfEndedJobs(database);
  if (kept <= limits.max_store_bytes) return;
  database.Fail(LimitExceeded("TOO_MANY_STORED_BYTES",
                              absl::StrCat("pinned and active jobs take ", kept,
                                           " bytes: wait until some have ended, or unpin some"),
                              "max-store-bytes", static_cast<double>(limits.max_store_bytes)));
}

Labels LabelsOf(const v1::EnsembleJob& job) { return {job.labels().begin(), job.labels().end()}; }

// Whether a job with these labels can get more: no label changes its value, and there are not too
// many.
bool Fit(const Labels& labels, Labels more) {
  for (const auto& [key, value] : labels) {
    if (more.emplace(key, value).first->second != value) return false;
  }
  return more.size() <= kMostLabels;
}

std::optional<JobRecord> FindOriginal(Database& database, const JobRecord& record) {
  const std::string& principal = record.job.principal();
  auto original = FindJobOfRequest(database, principal, record.request_id);
  const bool is_other =
      original ? original->payload != record.payload
               : FindJobOfCancellation(database, principal, record.request_id).has_value();
  if (is_other) database.Fail(RequestIdReused(record.request_id));
  return original;
}

std::optional<JobRecord> FindStored(Database& database, const JobRecord& record) {
  const Labels labels = LabelsOf(record.job);
  return FindAnswer(database, record.job.principal(), record.question,
                    [&](const v1::EnsembleJob& earlier) { return Fit(LabelsOf(earlier), labels); });
}

// Adds the labels to the job. The labels of a retry replace the job's values. Refused if the job
// would have more labels than are permitted.
void AddLabels(Database& database, const Labels& more, JobRecord& record) {
  const Labels before = LabelsOf(record.job);
  auto& labels = *record.job.mutable_labels();
  for (const auto& [key, value] : more) labels[key] = value;
  if (labels.size() > kMostLabels) {
    database.Fail(InvalidRequest(
        {{"labels", absl::StrCat("would give ", record.job.name(), " ", labels.size(),
                                 "; permitted: at most ", kMostLabels)}}));
  }
  if (LabelsOf(record.job) != before) UpdateJob(database, record);
}

// Sets the job that the new job continues, if there is one. The earlier job may have passed the new
// job's tolerance before its last sample; then the points are computed from the start.
void Continue(Database& database, Acceptance& acceptance) {
  v1::EnsembleJob& job = acceptance.record.job;
  const v1::Target& target = job.spec().target();
  const auto asks_for_more = [&](const v1::EnsembleJob& earlier) {
    const double samples = earlier.progress().samples();
    if (samples == 0) return false;
    if (!target.has_tolerance()) return acceptance.samples >= samples;
    const v1::Target& before = earlier.spec().target();
    return !before.has_tolerance() || target.tolerance() < before.tolerance();
  };
  for (const JobRecord& earlier : FindFamily(database, job.principal(), acceptance.record.family)) {
    if (!asks_for_more(earlier.job)) continue;
    job.set_continues(earlier.job.name());
    job.set_continued_samples(earlier.job.progress().samples());
    return;
  }
}

}  // namespace

// An answer from the store stores no request. So a retry asks the question again: it returns the
// same job, another job with the same answer, or, if these were deleted, a new job.
std::optional<JobRecord> Accept(Database& database, const Limits& limits, Acceptance& acceptance) {
  JobRecord& record = acceptance.record;
  std::optional<JobRecord> earlier = FindOriginal(database, record);
  const bool is_retry = earlier.has_value();
  if (!is_retry && !acceptance.fresh) earlier = FindStored(database, record);
  if (earlier) {
    AddLabels(database, LabelsOf(record.job), *earlier);
    earlier->job.set_answered_from_store(!is_retry);
    return earlier;
  }
  if (!acceptance.violations.empty()) database.Fail(InvalidSpec(acceptance.violations));
  CheckLoad(database, limits, record.job);
  CheckStoreSize(database, limits, acceptance.active_bytes);
  if (!acceptance.fresh) Continue(database, acceptance);
  InsertJob(database, record);
  return std::nullopt;
}

std::string QuestionOf(const v1::EnsembleSpec& spec, const std::string& engine_version) {
  if (spec.target().has_budget()) return std::string();
  return Sha256(absl::StrCat(engine_version, "\n", QuestionBytes(spec)));
}

std::string FamilyOf(const v1::EnsembleSpec& spec, const std::string& engine_version) {
  if (spec.target().has_budget()) return std::string();
  v1::EnsembleSpec family = spec;
  family.mutable_target()->clear_kind();
  if (family.target().ByteSizeLong() == 0) family.clear_target();
  return Sha256(absl::StrCat(engine_version, "\nfamily\n", QuestionBytes(family)));
}

std::string PayloadOf(const v1::CreateEnsembleJobRequest& request) {
  return Sha256(absl::StrCat(request.fresh() ? "fresh" : "", "\n", request.priority(), "\n",
                             QuestionBytes(request.spec())));
}

}  // namespace ballpiston::server
