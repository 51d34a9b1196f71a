// Resuming the jobs of an earlier process (active_jobs.h).
#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/engine_version.h"
#include "server/book/acceptance.h"
#include "server/book/active_jobs.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "server/status/failpoint.h"
#include "server/status/log.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"

namespace ballpiston::server {
namespace {

constexpr char kComputedAlone[] =
    "; it is computed alone until its next chunk is stored, for two minutes at most";

std::string Text(const std::set<size_t>& points) { return absl::StrJoin(points, " "); }

bool IsOfOtherEngine(const JobRecord& record) {
  return record.job.engine_version() != EngineVersion() &&
         record.job.state() != v1::EnsembleJob::CANCELLING;
}

// Sets the first finished point that missed its tolerance, if any.
void ReadShortfall(Database& database, const JobRecord& record, const EnsembleSpec& spec,
                   std::optional<Shortfall>& shortfall) {
  if (!spec.target.tolerance) return;
  ReadResults(database, record.sequence, 0, Details::kLeftOut, [&](const PointRow& row) {
    const v1::PointResult result = database.ValueOf(ResultFromBytes(row.result));
    // Closed forms and the spectrum take no samples. A billiard may end without one that counts.
    const bool takes_samples = result.model() != v1::EnsembleSpec::CLOSED_FORM &&
                               result.model() != v1::EnsembleSpec::SPECTRUM;
    if (!takes_samples) return true;
    const Estimate reached = FirstEstimateOf(result);
    if (RelativeError(reached) <= *spec.target.tolerance) return true;
    const auto point = static_cast<size_t>(row.point);
    shortfall = {point, ToleranceNotReached(spec, point, reached)};
    return false;
  });
}

// Sets the points that are finished. DATA_LOSS if the job's rows contradict each other.
std::vector<PointSize> ReadFinished(Database& database, const JobRecord& record,
                                    RunRequest& request) {
  const size_t in_grid = PointCount(request.spec);
  const auto is_of_the_grid = [&](const PointSize& point) {
    return point.point >= 0 && point.point < record.job.progress().points();
  };
  std::vector<PointSize> points = ListFinishedPoints(database, record.sequence);
  const bool fits = record.job.progress().points() == static_cast<int64_t>(in_grid);
  if (!fits || !std::ranges::all_of(points, is_of_the_grid)) {
    database.Fail(
        absl::DataLossError(absl::StrCat("the store's rows of ", record.job.name(),
                                         " do not fit its specification of ", in_grid, " points")));
    return {};
  }
  request.finished.assign(in_grid, false);
  for (const PointSize& point : points) request.finished[static_cast<size_t>(point.point)] = true;
  return points;
}

}  // namespace

absl::Status ActiveJobs::Resume() {
  absl::StatusOr<std::vector<JobRecord>> unfinished = store_.Read(ListUnfinishedJobs);
  if (!unfinished.ok()) return unfinished.status();
  const absl::Status restarted = RestartOlder(*unfinished);
  if (!restarted.ok()) return restarted;
  std::set<RunName> runs;
  for (const JobRecord& record : *unfinished) runs.insert(RunOf(record));
  crashes_.ClearAllBut(runs);
  for (const JobRecord& record : *unfinished) {
    const absl::Status resumed = ResumeJob(record);
    Failpoint("resume.job");
    if (!resumed.ok()) return resumed;
  }
  return store_.Flush();
}

// Restarts all jobs of another engine version in one commit, because there may be many.
absl::Status ActiveJobs::RestartOlder(std::vector<JobRecord>& unfinished) {
  std::vector<JobRecord*> older;
  for (JobRecord& record : unfinished) {
    if (!IsOfOtherEngine(record)) continue;
    v1::EnsembleJob& job = record.job;
    if (!CheckSpec(job.spec()).violations.empty()) continue;
    job.set_engine_version(EngineVersion());
    job.clear_continues();
    job.clear_continued_samples();
    record.question = QuestionOf(job.spec(), EngineVersion());
    record.family = FamilyOf(job.spec(), EngineVersion());
    ++record.restarts;
    older.push_back(&record);
    LogInfo(absl::StrCat(record.job.name(), " is computed again by engine ", EngineVersion()));
  }
  if (older.empty()) return absl::OkStatus();
  return store_.CommitDeletion([&](Database& database) {
    for (const JobRecord* record : older) {
      RestartJob(database, *record);
    }
  });
}

absl::Status ActiveJobs::ResumeJob(const JobRecord& record) {
  if (record.job.state() == v1::EnsembleJob::CANCELLING) {
    return End(record, absl::CancelledError("cancelled"));
  }
  const CrashRecord::Entry examining(crashes_, RunOf(record));
  if (crashes_.Deaths(RunOf(record)) >= kMostDeaths) return EndCrashed(record);
  if (!record.job.has_spec()) {
    return End(record, StoreFailure(absl::DataLossError("the stored job cannot be read")));
  }
  CheckedSpec checked = CheckSpec(record.job.spec());
  if (!checked.violations.empty()) return End(record, InvalidSpec(checked.violations));
  return ResumeRun(record, std::move(checked.spec));
}

absl::Status ActiveJobs::ResumeRun(const JobRecord& record, EnsembleSpec spec) {
  RunRequest request;
  request.spec = std::move(spec);
  request.has_checkpoints = true;
  const absl::StatusOr<std::vector<PointSize>> points = store_.Read([&](Database& database) {
    std::vector<PointSize> finished = ReadFinished(database, record, request);
    ReadShortfall(database, record, request.spec, request.shortfall);
    return finished;
  });
  if (absl::IsDataLoss(points.status())) return End(record, StoreFailure(points.status()));
  if (!points.ok()) return points.status();
  request.suspicion = SuspicionOf(record);
  const std::shared_ptr<Job> job = Add(record);
  job->AddRestoredPoints(*points);
  StartRun(job, std::move(request));
  return absl::OkStatus();
}

absl::Status ActiveJobs::End(const JobRecord& record, const absl::Status& why) {
  const absl::StatusOr<std::vector<PointSize>> points = store_.Read(
      [&](Database& database) { return ListFinishedPoints(database, record.sequence); });
  if (!points.ok()) return points.status();
  const auto job = std::make_shared<Job>(record);
  job->AddRestoredPoints(*points);
  JournalOf(job, true)->Ended(why);
  return absl::OkStatus();
}

absl::Status ActiveJobs::EndCrashed(const JobRecord& record) {
  const std::string points = Text(crashes_.LastPoints(RunOf(record)));
  return End(record, EngineCrashed(points.empty() ? "this job" : "points " + points,
                                   absl::StrCat(crashes_.Deaths(RunOf(record)))));
}

std::optional<Suspicion> ActiveJobs::SuspicionOf(const JobRecord& record) {
  const int deaths = crashes_.Deaths(RunOf(record));
  if (deaths == 0) return std::nullopt;
  const bool is_suspect = deaths >= kDeathsOfASuspect;
  const std::set<size_t> points = crashes_.LastPoints(RunOf(record));
  Log(Severity::kWarning,
      absl::StrCat("the server died ", deaths, deaths == 1 ? " time" : " times",
                   " while it computed this job", is_suspect ? kComputedAlone : ""),
      {{"job", record.job.name()},
       {"principal", record.job.principal()},
       {"points", Text(points)}});
  if (!is_suspect) return std::nullopt;
  const auto end = [&store = store_, &crashes = crashes_, run = RunOf(record),
                    name = record.job.name()](bool is_refuted) {
    if (!store.Flush().ok()) return false;
    is_refuted ? crashes.Clear(run) : crashes.KeepOneDeath(run);
    Log(Severity::kInfo, "this job was computed alone without a crash; other jobs continue",
        {{"job", name}});
    return true;
  };
  return Suspicion{.points = points, .end = end};
}

}  // namespace ballpiston::server
