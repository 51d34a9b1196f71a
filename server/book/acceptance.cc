#include "server/book/acceptance.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/book/job_name.h"
#include "server/convert/errors.h"
#include "server/convert/spec.h"
#include "server/sha256.h"
#include "server/store/labels.h"
#include "server/store/sweeper.h"

namespace ballpiston::server {
namespace {

constexpr char kWait[] = "wait until some jobs have ended, or cancel some of yours";

// Refuses the job if it, or its principal's active jobs together, would exceed a limit.
void CheckLoad(Database& database, const Limits& limits, const JobRecord& job) {
  const Load load = ActiveLoad(database, job.principal);
  const std::string& principal = job.principal;
  const auto check = [&](int64_t with_job, int64_t most, const char* reason, const char* flag,
                         const std::string& what) {
    if (most == 0 || with_job <= most) return;
    database.Fail(LimitExceeded(reason, what, flag, static_cast<double>(most)));
  };
  check(job.points, limits.max_points_per_job, "TOO_MANY_POINTS", "max-points-per-job",
        absl::StrCat("the grid has ", job.points, " points: split it between several jobs"));
  check(load.jobs + 1, limits.max_active_jobs_per_principal, "TOO_MANY_JOBS",
        "max-active-jobs-per-principal",
        absl::StrCat(principal, " has ", load.jobs, " active jobs already: ", kWait));
  const int64_t points = load.points + job.points;
  check(points, limits.max_active_points_per_principal, "TOO_MANY_ACTIVE_POINTS",
        "max-active-points-per-principal",
        absl::StrCat(principal, "'s active jobs would have ", points,
                     " points with this one: ", kWait));
}

// Refuses the job if pinned and active jobs alone exceed the limit. All other jobs are removed when
// the store is full (retention.cc).
void CheckStoreSize(Database& database, const Limits& limits) {
  const int64_t used = UsedBytes(database);
  if (limits.max_store_bytes == 0 || used <= limits.max_store_bytes) return;
  const int64_t kept = used - RemovableBytes(database);
  if (kept <= limits.max_store_bytes || IsSweeping(database)) return;
  database.Fail(LimitExceeded("TOO_MANY_STORED_BYTES",
                              absl::StrCat("pinned and active jobs take ", kept,
                                           " bytes: wait until some have ended, or unpin some"),
                              "max-store-bytes", static_cast<double>(limits.max_store_bytes)));
}

// Whether a job with these labels can get more: no label changes its value, and there are not too
// many.
bool Fit(const Labels& labels, Labels more) {
  for (const auto& [key, value] : labels) {
    if (more.emplace(key, value).first->second != value) return false;
  }
  return more.size() <= kMostLabels;
}

std::optional<EarlierJob> FindEarlier(Database& database, const Acceptance& acceptance) {
  const JobRecord& record = acceptance.record;
  if (auto original = FindJobOfRequest(database, record.principal, record.request_id)) {
    if (original->payload != record.payload) database.Fail(RequestIdReused(record.request_id));
    return EarlierJob{*std::move(original)};
  }
  if (acceptance.fresh) return std::nullopt;
  const Labels labels = LabelsOf(record.labels);
  auto answer = FindAnswer(database, record.principal, record.question,
                           [&](const std::string& text) { return Fit(LabelsOf(text), labels); });
  return answer ? std::optional(EarlierJob{*std::move(answer), true}) : std::nullopt;
}

// Adds the labels to the job. The labels of a retry replace the job's values. Refused if the job
// would have more labels than are permitted.
void AddLabels(Database& database, const Labels& more, JobRecord& record) {
  Labels labels = LabelsOf(record.labels);
  for (const auto& [key, value] : more) labels.insert_or_assign(key, value);
  if (labels.size() > kMostLabels) {
    database.Fail(InvalidRequest(
        {{"labels", absl::StrCat("would give ", JobName(record.id), " ", labels.size(),
                                 "; permitted: at most ", kMostLabels)}}));
  }
  const std::string text = LabelsText(labels);
  if (text == record.labels) return;
  record.labels = text;
  UpdateJob(database, record);
}

// Sets which job the new one continues, if there is one. A tolerance may have been reached before
// the end of a number of samples; then the points begin anew.
void Continue(Database& database, Acceptance& acceptance) {
  JobRecord& record = acceptance.record;
  const auto target_of = [&database](const JobRecord& job) {
    return database.ValueOf(SpecFromBytes({job.spec.rest})).target();
  };
  const v1::Target target = target_of(record);
  const auto asks_for_more = [&](const JobRecord& earlier) {
    if (earlier.numbers.samples == 0) return false;
    if (!target.has_tolerance()) return acceptance.samples > earlier.numbers.samples;
    const v1::Target before = target_of(earlier);
    return !before.has_tolerance() || target.tolerance() < before.tolerance();
  };
  for (const JobRecord& earlier : FindFamily(database, record.principal, record.family)) {
    if (!asks_for_more(earlier)) continue;
    record.continues = earlier.id;
    record.continued_samples = earlier.numbers.samples;
    return;
  }
}

}  // namespace

// An answer from the store stores no request: a retry finds the same answer.
std::optional<EarlierJob> Accept(Database& database, const Limits& limits, Acceptance& acceptance) {
  JobRecord& record = acceptance.record;
  if (auto earlier = FindEarlier(database, acceptance)) {
    if (!record.labels.empty()) AddLabels(database, LabelsOf(record.labels), earlier->record);
    return earlier;
  }
  CheckLoad(database, limits, record);
  CheckStoreSize(database, limits);
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
