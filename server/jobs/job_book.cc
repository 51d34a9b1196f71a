#include "server/jobs/job_book.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "server/jobs/job_journal.h"
#include "server/jobs/job_message.h"
#include "server/jobs/job_name.h"
#include "server/jobs/job_state.h"
#include "server/observability/log.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"

namespace ballpiston::server {
namespace {

struct FinishedPoints {
  std::vector<bool> finished;
  int64_t count = 0;
  double samples = 0;
  std::vector<Job::FinishedPoint> recent;
};

absl::Status ReadRecent(Database& database, int64_t sequence, int64_t first,
                        std::vector<Job::FinishedPoint>& recent) {
  absl::Status parsed;
  const absl::Status read = ReadResults(database, sequence, first, [&](PointRow row) {
    absl::StatusOr<v1::PointResult> result = PointResultFromBytes(row.result);
    parsed = result.status();
    if (!parsed.ok()) return false;
    ClearDetails(*result);
    recent.push_back(std::make_shared<const v1::PointResult>(*std::move(result)));
    return true;
  });
  return read.ok() ? parsed : read;
}

absl::Status ReadFinishedPoints(Database& database, const JobRecord& record,
                                FinishedPoints& points) {
  const auto rows = ListFinishedPoints(database, record.sequence);
  if (!rows.ok()) return rows.status();
  points.finished.assign(static_cast<size_t>(record.points), false);
  for (const PointRow& row : *rows) {
    if (row.point < 0 || row.point >= record.points) continue;
    points.finished[static_cast<size_t>(row.point)] = true;
    points.samples += row.samples;
    ++points.count;
  }
  if (rows->empty()) return absl::OkStatus();
  const size_t first = rows->size() - std::min(rows->size(), kRecentPoints);
  return ReadRecent(database, record.sequence, (*rows)[first].point, points.recent);
}

// The first finished point that an earlier process had to leave short of the tolerance, if any.
absl::Status ReadShortfall(Database& database, const JobRecord& record, const EnsembleSpec& spec,
                           std::optional<Shortfall>& shortfall) {
  if (!spec.target.tolerance || !spec.target.budget_seconds) return absl::OkStatus();
  absl::Status parsed;
  const absl::Status read = ReadResults(database, record.sequence, 0, [&](PointRow row) {
    const absl::StatusOr<v1::PointResult> result = PointResultFromBytes(row.result);
    parsed = result.status();
    if (!parsed.ok()) return false;
    const Estimate reached = FirstEstimateOf(*result);
    if (MeetsTolerance(reached, *spec.target.tolerance)) return true;
    const auto point = static_cast<size_t>(row.point);
    shortfall = {point, ToleranceNotReached(spec, point, reached)};
    return false;
  });
  return read.ok() ? parsed : read;
}

}  // namespace

JobBook::JobBook(Store& store, int workers, ExperimentFactory factory,
                 std::function<void()> on_state_change)
    : store_(store),
      on_state_change_(std::move(on_state_change)),
      pool_(workers, std::move(factory)) {}

JobBook::~JobBook() { Shutdown(); }

void JobBook::Shutdown() {
  store_.StopWaiting();
  pool_.Shutdown();
}

// ---- what an earlier process left ----

absl::Status JobBook::Resume() {
  absl::StatusOr<std::vector<JobRecord>> unfinished;
  const absl::Status read = store_.Read([&](Database& database) {
    unfinished = ListUnfinishedJobs(database);
    return unfinished.status();
  });
  if (!read.ok()) return read;
  for (JobRecord& record : *unfinished) {
    const absl::Status resumed = ResumeJob(std::move(record));
    if (!resumed.ok()) return resumed;
  }
  return absl::OkStatus();
}

absl::Status JobBook::ResumeJob(JobRecord record) {
  if (record.state == v1::EnsembleJob::CANCELLING) {
    return EndUnresumable(record, absl::CancelledError("cancelled"));
  }
  const absl::StatusOr<v1::EnsembleSpec> message = SpecFromBytes(record.spec);
  if (!message.ok()) return EndUnresumable(record, message.status());
  CheckedSpec checked = CheckSpec(*message);
  if (!checked.violations.empty()) return EndUnresumable(record, InvalidSpec(checked.violations));
  if (record.engine_version != EngineVersion()) {
    record.engine_version = EngineVersion();
    const absl::Status restarted = store_.Commit([&](Database& database) {
      return RestartJob(database, record.sequence, record.engine_version);
    });
    if (!restarted.ok()) return restarted;
    LogInfo(
        absl::StrCat(JobName(record.id), " is computed anew by engine ", record.engine_version));
  }
  return ResumeRun(std::move(record), std::move(checked.spec));
}

// It ends as a run that had nothing more to do would.
absl::Status JobBook::EndUnresumable(const JobRecord& record, const absl::Status& why) {
  FinishedPoints points;
  const absl::Status read =
      store_.Read([&](Database& database) { return ReadFinishedPoints(database, record, points); });
  if (!read.ok()) return read;
  auto job = std::make_shared<Job>(record, nullptr);
  job->AddRestoredPoints(points.count, points.samples, {});
  JobJournal(job, store_, nullptr).Ended(why);
  return store_.Flush();
}

absl::Status JobBook::ResumeRun(JobRecord record, EnsembleSpec spec) {
  FinishedPoints points;
  std::optional<Shortfall> shortfall;
  const absl::Status read = store_.Read([&](Database& database) {
    const absl::Status finished = ReadFinishedPoints(database, record, points);
    return finished.ok() ? ReadShortfall(database, record, spec, shortfall) : finished;
  });
  if (!read.ok()) return read;
  std::shared_ptr<Job> job = Register(std::move(record));
  job->AddRestoredPoints(points.count, points.samples, std::move(points.recent));
  RunRequest request;
  request.spec = std::move(spec);
  request.finished = std::move(points.finished);
  request.has_stored_blocks = true;
  request.shortfall = std::move(shortfall);
  StartRun(std::move(job), std::move(request));
  return absl::OkStatus();
}

std::shared_ptr<Job> JobBook::Register(JobRecord record) {
  auto job = std::make_shared<Job>(std::move(record), on_state_change_);
  std::lock_guard lock(mutex_);
  active_.emplace(job->id(), job);
  return job;
}

void JobBook::StartRun(std::shared_ptr<Job> job, RunRequest request) {
  request.key = job->sequence();
  request.journal = std::make_shared<JobJournal>(std::move(job), store_, [this](const Job& ended) {
    std::lock_guard lock(mutex_);
    active_.erase(ended.id());
  });
  pool_.Add(std::move(request));
}

// ---- the methods ----

JobRecord JobBook::NewRecord(const v1::EnsembleSpec& message, const CheckedSpec& checked) const {
  JobRecord record;
  record.spec = SpecBytes(message);
  record.create_time = absl::Now();
  record.engine_version = EngineVersion();
  record.points = static_cast<int64_t>(PointCount(checked.spec));
  return record;
}

v1::EnsembleJob JobBook::Preview(const v1::EnsembleSpec& message,
                                 const CheckedSpec& checked) const {
  return JobMessage(NewRecord(message, checked));
}

absl::StatusOr<v1::EnsembleJob> JobBook::Create(const v1::EnsembleSpec& message,
                                                const CheckedSpec& checked,
                                                const std::string& request_id) {
  JobRecord record = NewRecord(message, checked);
  record.id = RandomId();
  record.request_id = request_id;
  std::optional<JobRecord> earlier;
  const auto insert = [&](Database& database) -> absl::Status {
    earlier.reset();
    if (!request_id.empty()) {
      auto found = FindJobByRequest(database, request_id);
      if (!found.ok()) return found.status();
      earlier = *std::move(found);
    }
    return earlier ? absl::OkStatus() : InsertJob(database, record);
  };
  // Begun before anybody else can see the job in the store.
  std::shared_ptr<Job> job;
  const absl::Status committed = store_.Commit(insert, [&](const absl::Status& done) {
    if (!done.ok() || earlier) return;
    job = Register(record);
    RunRequest request;
    request.spec = checked.spec;
    request.finished.assign(static_cast<size_t>(record.points), false);
    StartRun(job, std::move(request));
  });
  if (!committed.ok()) return StoreFailure(committed);
  if (!earlier) return job->Message();
  if (earlier->spec != record.spec) return RequestIdReused(request_id);
  return Get(earlier->id);
}

std::shared_ptr<Job> JobBook::ActiveOrNull(const std::string& id) const {
  std::lock_guard lock(mutex_);
  const auto found = active_.find(id);
  return found == active_.end() ? nullptr : found->second;
}

absl::StatusOr<JobRecord> JobBook::ReadRecord(const std::string& id) {
  std::optional<JobRecord> record;
  const absl::Status read = store_.Read([&](Database& database) {
    auto found = FindJob(database, id);
    if (found.ok()) record = *std::move(found);
    return found.status();
  });
  if (!read.ok()) return StoreFailure(read);
  if (!record) return JobNotFound(JobName(id));
  return *std::move(record);
}

absl::StatusOr<v1::EnsembleJob> JobBook::Get(const std::string& id) {
  // In this order: a job leaves the book only when its end is in the store.
  if (const std::shared_ptr<Job> job = ActiveOrNull(id)) return job->Message();
  const absl::StatusOr<JobRecord> record = ReadRecord(id);
  if (!record.ok()) return record.status();
  return JobMessage(*record);
}

absl::StatusOr<std::vector<ListedJob>> JobBook::List(int64_t before, int limit) {
  std::map<std::string, std::shared_ptr<Job>> active;
  {
    std::lock_guard lock(mutex_);
    active = active_;
  }
  absl::StatusOr<std::vector<JobRecord>> records;
  const absl::Status read = store_.Read([&](Database& database) {
    records = ListJobs(database, before, limit);
    return records.status();
  });
  if (!read.ok()) return StoreFailure(read);
  std::vector<ListedJob> listed;
  for (const JobRecord& record : *records) {
    const auto job = active.find(record.id);
    const bool now = job != active.end() && !HasEnded(record.state);
    listed.push_back({record.sequence, now ? job->second->Message() : JobMessage(record)});
  }
  return listed;
}

absl::StatusOr<v1::EnsembleJob> JobBook::Cancel(const std::string& id,
                                                const std::string& request_id) {
  std::optional<JobRecord> record;
  bool begun = false;
  const auto begin = [&](Database& database) -> absl::Status {
    auto found = FindJob(database, id);
    if (!found.ok()) return found.status();
    record = *std::move(found);
    if (!record) return absl::OkStatus();
    const auto changed = BeginCancellation(database, record->sequence, request_id);
    begun = changed.ok() && *changed;
    return changed.status();
  };
  const absl::Status committed = store_.Commit(begin, [&](const absl::Status& done) {
    const std::shared_ptr<Job> job = ActiveOrNull(id);
    if (done.ok() && begun && job) job->Enter(v1::EnsembleJob::CANCELLING, absl::Now());
  });
  if (!committed.ok()) return StoreFailure(committed);
  if (!record) return JobNotFound(JobName(id));
  if (begun) pool_.Cancel(record->sequence);
  const bool replay = !request_id.empty() && record->cancel_request_id == request_id;
  if (begun || replay || record->state == v1::EnsembleJob::CANCELLING) return Get(id);
  return JobAlreadyEnded(JobName(id), StateName(record->state));
}

absl::Status JobBook::Delete(const std::string& id) {
  std::optional<JobRecord> record;
  const absl::Status committed = store_.Commit([&](Database& database) -> absl::Status {
    auto found = FindJob(database, id);
    if (!found.ok()) return found.status();
    record = *std::move(found);
    if (!record || !HasEnded(record->state)) return absl::OkStatus();
    return DeleteJob(database, record->sequence);
  });
  if (!committed.ok()) return StoreFailure(committed);
  if (!record) return JobNotFound(JobName(id));
  if (HasEnded(record->state)) return absl::OkStatus();
  const std::shared_ptr<Job> job = ActiveOrNull(id);
  return JobStillActive(JobName(id), StateName(job ? job->state() : record->state));
}

absl::StatusOr<ResultsPage> JobBook::Results(const std::string& id, const ResultsQuery& query) {
  const absl::StatusOr<JobRecord> record = ReadRecord(id);
  if (!record.ok()) return record.status();
  ResultsPage page;
  size_t bytes = 0;
  absl::Status parsed;
  const auto take = [&](PointRow row) {
    absl::StatusOr<v1::PointResult> result = PointResultFromBytes(row.result);
    parsed = result.status();
    if (!parsed.ok()) return false;
    if (!query.histograms) ClearDetails(*result);
    bytes += result->ByteSizeLong();
    const bool full = page.points.size() == static_cast<size_t>(query.max_points);
    page.more = full || (!page.points.empty() && bytes > query.max_bytes);
    if (!page.more) page.points.push_back(*std::move(result));
    return !page.more;
  };
  const absl::Status read = store_.Read([&](Database& database) {
    return ReadResults(database, record->sequence, query.first_point, take);
  });
  if (!read.ok()) return StoreFailure(read);
  if (!parsed.ok()) return WithReason(parsed, "STORE_FAILED");
  return page;
}

absl::StatusOr<std::shared_ptr<Job>> JobBook::FindActive(const std::string& id) {
  if (std::shared_ptr<Job> job = ActiveOrNull(id)) return job;
  const absl::StatusOr<JobRecord> record = ReadRecord(id);
  if (!record.ok()) return record.status();
  if (HasEnded(record->state)) return nullptr;
  // Committed a moment ago: it is in the book when the store has gone on to the next commit.
  const absl::Status settled = store_.Flush();
  if (!settled.ok()) return StoreFailure(settled);
  return ActiveOrNull(id);
}

std::vector<v1::PointResult> JobBook::PointsChangedSince(const Job& job, uint64_t number,
                                                         size_t limit) const {
  std::vector<std::pair<uint64_t, v1::PointResult>> changed;
  for (const LivePoint& point : pool_.ChangedSince(job.sequence(), number, limit)) {
    changed.emplace_back(point.version, PointResultOf(point.index, *point.experiment, point.merged,
                                                      Details::kLeftOut));
  }
  for (const Job::Change& change : job.FinishedSince(number, limit)) {
    changed.emplace_back(change.number, *change.point);
  }
  const auto newer = [](const auto& a, const auto& b) { return a.first > b.first; };
  std::stable_sort(changed.begin(), changed.end(), newer);
  std::vector<v1::PointResult> points;
  std::set<int32_t> told;  // a point that is finished just now may be there twice
  for (auto& [change, point] : changed) {
    if (points.size() == limit) break;
    if (told.insert(point.index()).second) points.push_back(std::move(point));
  }
  return points;
}

size_t JobBook::active_jobs() const {
  std::lock_guard lock(mutex_);
  return active_.size();
}

}  // namespace ballpiston::server
