#include "server/jobs/job_book.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "server/host.h"
#include "server/jobs/acceptance.h"
#include "server/jobs/job_journal.h"
#include "server/jobs/job_log.h"
#include "server/jobs/job_message.h"
#include "server/jobs/job_name.h"
#include "server/jobs/question.h"
#include "server/observability/failpoint.h"
#include "server/observability/log.h"
#include "server/sha256.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"

namespace ballpiston::server {
namespace {

// Finished points are read until they have this many bytes.
constexpr size_t kMaxBytesOfPoints = size_t{512} << 10;

// Upper bound of the encoded size of the job's message: names, times and numbers take less than
// the constant.
size_t MostBytesOf(const JobRecord& record) {
  return 512 + record.principal.size() + record.engine_version.size() + record.spec.size() +
         record.error.size();
}

// Collects the records of one page, newest first, until one of the query's bounds is reached.
class PageOfRecords {
 public:
  explicit PageOfRecords(const JobsQuery& query) : query_(query) {}

  // False: the page ends before this record.
  bool Take(JobRecord record) {
    const size_t bytes = MostBytesOf(record);
    if (HasReadEnough(bytes) || IsFull()) return End();
    const bool matches = query_.filter.Matches(record);
    if (matches && !HasRoom(bytes)) return End();
    ++read_;
    bytes_read_ += bytes;
    last_read_ = record.sequence;
    if (!matches) return true;
    bytes_ += bytes;
    records_.push_back(std::move(record));
    return true;
  }

  const std::vector<JobRecord>& records() const { return records_; }
  std::optional<int64_t> next_before() const { return next_before_; }

 private:
  bool IsFull() const { return records_.size() == static_cast<size_t>(query_.max_jobs); }
  bool HasRoom(size_t bytes) const {
    return records_.empty() || bytes_ + bytes <= query_.max_bytes;
  }
  bool HasReadEnough(size_t bytes) const {
    return read_ > 0 &&
           (read_ == query_.max_jobs_read || bytes_read_ + bytes > query_.max_bytes_read);
  }
  bool End() {
    next_before_ = last_read_;
    return false;
  }

  const JobsQuery& query_;
  std::vector<JobRecord> records_;
  size_t bytes_ = 0;  // of these
  int read_ = 0;      // records read, matching or not
  size_t bytes_read_ = 0;
  int64_t last_read_ = 0;
  std::optional<int64_t> next_before_;
};

// The job, if the caller may see it.
absl::StatusOr<std::optional<JobRecord>> FindJobOf(Database& database, const Principal& caller,
                                                   const std::string& id) {
  auto found = FindJob(database, id, Grid::kLeftOut);
  if (found.ok() && *found && !caller.MaySee((*found)->principal)) return std::nullopt;
  return found;
}

// The points of a job that an earlier process finished.
struct StoredPoints {
  std::vector<PointRow> rows;  // without results
  int64_t last = 0;            // the number of the last of them
  double samples = 0;
  int64_t bytes = 0;

  int64_t count() const { return static_cast<int64_t>(rows.size()); }
};

absl::Status ReadStoredPoints(Database& database, const JobRecord& record, StoredPoints& points) {
  const auto last = LastResultNumber(database, record.sequence);
  if (!last.ok()) return last.status();
  auto rows = ListFinishedPoints(database, record.sequence);
  if (!rows.ok()) return rows.status();
  const auto bytes = BytesOfResults(database, record.sequence);
  if (!bytes.ok()) return bytes.status();
  points.last = *last;
  points.bytes = *bytes;
  points.rows = *std::move(rows);
  for (const PointRow& row : points.rows) points.samples += row.samples;
  return absl::OkStatus();
}

absl::Status CheckStoredPoints(const JobRecord& record, const EnsembleSpec& spec,
                               const StoredPoints& points) {
  const auto in_grid = static_cast<int64_t>(PointCount(spec));
  const auto is_beyond = [&](const PointRow& row) { return row.point < 0 || row.point >= in_grid; };
  if (record.points == in_grid && std::ranges::none_of(points.rows, is_beyond)) {
    return absl::OkStatus();
  }
  return absl::DataLossError(absl::StrCat("the store's rows of ", JobName(record.id),
                                          " do not fit its specification of ", in_grid, " points"));
}

void AddTo(Job& job, const StoredPoints& points) {
  job.AddRestoredPoints(points.count(), points.samples, points.last);
  job.AddBytes(points.bytes);
}

// Whether each point of the grid is finished.
std::vector<bool> Finished(const JobRecord& record, const StoredPoints& points) {
  std::vector<bool> finished(static_cast<size_t>(record.points), false);
  for (const PointRow& row : points.rows) finished[static_cast<size_t>(row.point)] = true;
  return finished;
}

// The first finished point that missed its tolerance in an earlier process, if any.
absl::Status ReadShortfall(Database& database, const JobRecord& record, const EnsembleSpec& spec,
                           std::optional<Shortfall>& shortfall, absl::Status& damage) {
  if (!spec.target.tolerance || !spec.target.budget_seconds) return absl::OkStatus();
  return ReadResults(database, record.sequence, 0, Details::kLeftOut, [&](PointRow row) {
    const absl::StatusOr<v1::PointResult> result = ResultFromBytes(row.result);
    damage = result.status();
    if (!damage.ok()) return false;
    const Estimate reached = FirstEstimateOf(*result);
    if (MeetsTolerance(reached, *spec.target.tolerance)) return true;
    const auto point = static_cast<size_t>(row.point);
    shortfall = {point, ToleranceNotReached(spec, point, reached)};
    return false;
  });
}

// Distinguishes a job from another job with the same sequence (before the store was restored from a
// backup), and from the same job under an older engine.
int64_t GenerationOf(const std::string& id, int64_t restarts) {
  const std::string hash = Sha256(absl::StrCat(id, " ", restarts));
  uint64_t number = 0;
  for (size_t i = 0; i < 7; ++i) number = number << 8 | static_cast<uint8_t>(hash[i]);
  return static_cast<int64_t>(number);
}

RunName RunOf(const JobRecord& record) {
  return {record.sequence, GenerationOf(record.id, record.restarts)};
}

bool HasCrashed(const JobRecord& ended) {
  google::rpc::Status error;
  return error.ParseFromString(ended.error) && ReasonOf(error) == kEngineCrashed;
}

RunName RunOf(const Job& job) { return {job.sequence(), GenerationOf(job.id(), job.restarts())}; }

std::string Text(const std::set<size_t>& points) {
  return points.empty() ? "" : absl::StrJoin(points, " ");
}

// The stored state from which a run is resumed. `damage`: the job's rows contradict each other.
struct Restored {
  StoredPoints points;
  std::optional<Shortfall> shortfall;
  absl::Status damage;
};

absl::Status ReadRestored(Database& database, const JobRecord& record, const EnsembleSpec& spec,
                          Restored& restored) {
  const absl::Status read = ReadStoredPoints(database, record, restored.points);
  if (!read.ok()) return read;
  restored.damage = CheckStoredPoints(record, spec, restored.points);
  if (!restored.damage.ok()) return absl::OkStatus();
  return ReadShortfall(database, record, spec, restored.shortfall, restored.damage);
}

}  // namespace

JobBook::JobBook(Store& store, const Limits& limits, Scheduler& scheduler,
                 std::shared_ptr<CrashRecord> crashes)
    : store_(store),
      limits_(limits),
      scheduler_(scheduler),
      crashes_(std::move(crashes)),
      retention_(store, limits) {}

JobBook::~JobBook() {
  Shutdown();
  store_.Close();  // the store's thread calls this book when it has written a job's end
}

void JobBook::Shutdown() {
  store_.StopWaiting();
  scheduler_.Shutdown();
  MutexLock lock(mutex_);
  for (const auto& [id, job] : active_) job->StopWaiting();
}

// ---- resuming jobs of an earlier process ----

absl::Status JobBook::Resume() {
  absl::StatusOr<std::vector<JobRecord>> unfinished;
  const absl::Status read = store_.Read([&](Database& database) {
    unfinished = ListUnfinishedJobs(database);
    return unfinished.status();
  });
  if (!read.ok()) return read;
  const absl::Status restarted = RestartOlder(*unfinished);
  if (!restarted.ok()) return restarted;
  std::set<RunName> runs;
  for (const JobRecord& record : *unfinished) runs.insert(RunOf(record));
  crashes_->ClearAllBut(runs);
  for (const JobRecord& record : *unfinished) {
    const absl::Status resumed = ResumeJob(record);
    Failpoint("resume.job");
    if (!resumed.ok()) return resumed;
  }
  return store_.Flush();
}

// Restarts all jobs of another engine version in one commit, because there may be many.
absl::Status JobBook::RestartOlder(std::vector<JobRecord>& unfinished) {
  std::vector<JobRecord*> older;
  for (JobRecord& record : unfinished) {
    if (record.engine_version == EngineVersion()) continue;
    if (record.state == v1::EnsembleJob::CANCELLING) continue;
    const absl::StatusOr<v1::EnsembleSpec> message = SpecFromBytes(record.spec);
    if (!message.ok() || !CheckSpec(*message).violations.empty()) continue;
    record.engine_version = EngineVersion();
    record.question = QuestionOf(*message, record.engine_version);
    ++record.restarts;
    older.push_back(&record);
    LogInfo(
        absl::StrCat(JobName(record.id), " is computed again by engine ", record.engine_version));
  }
  if (older.empty()) return absl::OkStatus();
  return store_.CommitDeletion([&](Database& database) {
    for (const JobRecord* record : older) {
      const absl::Status restarted =
          RestartJob(database, record->sequence, record->engine_version, record->question);
      if (!restarted.ok()) return restarted;
    }
    return absl::OkStatus();
  });
}

absl::Status JobBook::ResumeJob(const JobRecord& record) {
  if (record.state == v1::EnsembleJob::CANCELLING) {
    return EndUnresumable(record, absl::CancelledError("cancelled"));
  }
  const CrashRecord::Examining examining(*crashes_, RunOf(record));
  if (crashes_->Deaths(RunOf(record)) >= kMostDeaths) return EndCrashed(record);
  const absl::StatusOr<v1::EnsembleSpec> message = SpecFromBytes(record.spec);
  if (!message.ok()) return EndUnresumable(record, message.status());
  CheckedSpec checked = CheckSpec(*message);
  if (!checked.violations.empty()) return EndUnresumable(record, InvalidSpec(checked.violations));
  return ResumeRun(record, std::move(checked.spec));
}

absl::Status JobBook::EndCrashed(const JobRecord& record) {
  const absl::StatusOr<v1::EnsembleSpec> spec = SpecFromBytes(record.spec);
  const std::string points = Text(crashes_->LastPoints(RunOf(record)));
  LogCrashed(record, points, spec.value_or(v1::EnsembleSpec()));
  return EndUnresumable(record, EngineCrashed(points.empty() ? "this job" : "points " + points,
                                              crashes_->Deaths(RunOf(record))));
}

// Empty unless the job was being computed at two deaths of the process.
std::optional<Suspicion> JobBook::SuspicionOf(const JobRecord& record) {
  const RunName run = RunOf(record);
  const int deaths = crashes_->Deaths(run);
  if (deaths == 0) return std::nullopt;
  const bool is_suspect = deaths >= kDeathsOfASuspect;
  const std::set<size_t> points = crashes_->LastPoints(run);
  Log(Severity::kWarning,
      absl::StrCat("the server died ", deaths, deaths == 1 ? " time" : " times",
                   " while it computed this job",
                   is_suspect ? "; it is computed alone until its next chunk is stored" : ""),
      {{"job", JobName(record.id)}, {"principal", record.principal}, {"points", Text(points)}});
  if (!is_suspect) return std::nullopt;
  const auto clear = [this, run, name = JobName(record.id)] {
    if (!store_.Flush().ok()) return false;
    crashes_->Clear(run);
    Log(Severity::kInfo, "this job was computed alone without a crash; other jobs continue",
        {{"job", name}});
    return true;
  };
  return Suspicion{.points = points, .clear = clear};
}

// Ends the job like a run that has nothing left to compute. The end is on disk when all jobs are
// resumed.
absl::Status JobBook::EndUnresumable(const JobRecord& record, const absl::Status& why) {
  StoredPoints points;
  const absl::Status read =
      store_.Read([&](Database& database) { return ReadStoredPoints(database, record, points); });
  if (!read.ok()) return read;
  auto job = std::make_shared<Job>(record);
  AddTo(*job, points);
  JobJournal(job, store_, true, nullptr).Ended(why);
  return absl::OkStatus();
}

absl::Status JobBook::ResumeRun(const JobRecord& record, EnsembleSpec spec) {
  Restored restored;
  const absl::Status read = store_.Read(
      [&](Database& database) { return ReadRestored(database, record, spec, restored); });
  if (!read.ok()) return read;
  if (!restored.damage.ok()) {
    return EndUnresumable(record, StoreFailure(restored.damage));
  }
  const StoredPoints& points = restored.points;
  RunRequest request;
  request.finished = Finished(record, points);
  request.spec = std::move(spec);
  request.has_checkpoints = true;
  request.shortfall = std::move(restored.shortfall);
  request.suspicion = SuspicionOf(record);
  std::shared_ptr<Job> job = Register(record);
  AddTo(*job, points);
  StartRun(std::move(job), record, std::move(request));
  return absl::OkStatus();
}

std::shared_ptr<Job> JobBook::Register(const JobRecord& record) {
  auto job = std::make_shared<Job>(record);
  MutexLock lock(mutex_);
  active_[record.id] = job;
  return job;
}

void JobBook::Forget(const std::string& id) {
  MutexLock lock(mutex_);
  active_.erase(id);
}

void JobBook::StartRun(std::shared_ptr<Job> job, const JobRecord& record, RunRequest request) {
  request.key = record.sequence;
  request.generation = RunOf(record).generation;
  request.principal = record.principal;
  request.priority = record.priority;
  request.journal =
      std::make_shared<JobJournal>(std::move(job), store_, request.has_checkpoints,
                                   [this](const JobRecord& ended) { OnEnded(ended); });
  scheduler_.Add(std::move(request));
}

void JobBook::OnEnded(const JobRecord& ended) {
  if (HasCrashed(ended))
    LogCrashed(ended, "", SpecFromBytes(ended.spec).value_or(v1::EnsembleSpec()));
  ++(ended.state == v1::EnsembleJob::SUCCEEDED ? succeeded_
     : ended.state == v1::EnsembleJob::FAILED  ? failed_
                                               : cancelled_);
  Forget(ended.id);
}

// ---- the methods ----

JobRecord JobBook::NewRecord(const Principal& caller, const v1::CreateEnsembleJobRequest& request,
                             const CheckedSpec& checked) const {
  JobRecord record;
  record.principal = caller.name;
  record.priority = request.priority();
  record.spec = SpecBytes(request.spec());
  record.engine_version = EngineVersion();
  record.question = QuestionOf(request.spec(), record.engine_version);
  record.spec_bytes = static_cast<int64_t>(record.spec.size());
  record.bytes = record.spec_bytes;
  record.create_time = WallNow();
  record.points = static_cast<int64_t>(PointCount(checked.spec));
  return record;
}

Acceptance JobBook::NewAcceptance(const Principal& caller,
                                  const v1::CreateEnsembleJobRequest& request,
                                  const CheckedSpec& checked) const {
  Acceptance acceptance;
  acceptance.record = NewRecord(caller, request, checked);
  acceptance.request.principal = caller.name;
  acceptance.request.request_id = request.request_id();
  acceptance.request.payload = PayloadOf(request);
  acceptance.fresh = request.fresh();
  acceptance.fits = CheckSize(checked.spec, limits_);
  return acceptance;
}

absl::StatusOr<v1::EnsembleJob> JobBook::Preview(const Principal& caller,
                                                 const v1::CreateEnsembleJobRequest& request,
                                                 const CheckedSpec& checked) {
  Acceptance acceptance = NewAcceptance(caller, request, checked);
  const absl::Status read =
      store_.Read([&](Database& database) { return Judge(database, limits_, acceptance); });
  if (!read.ok()) return StoreFailure(read);
  if (!acceptance.refused.ok()) return acceptance.refused;
  return acceptance.earlier ? Answer(caller, acceptance) : Message(acceptance.record, nullptr);
}

absl::StatusOr<v1::EnsembleJob> JobBook::Create(const Principal& caller,
                                                const v1::CreateEnsembleJobRequest& request,
                                                const CheckedSpec& checked) {
  Acceptance acceptance = NewAcceptance(caller, request, checked);
  acceptance.record.id = RandomId();
  std::shared_ptr<Job> job;  // the new job, if there is one
  const absl::Status committed = store_.Commit([&](Database& database) {
    job = nullptr;
    const absl::Status accepted = Accept(database, limits_, acceptance);
    Failpoint("create.in_transaction");
    if (accepted.ok() && !acceptance.earlier && acceptance.refused.ok()) {
      job = Register(acceptance.record);
    }
    return accepted;
  });
  Failpoint("create.committed");
  if (!committed.ok() || job == nullptr) Forget(acceptance.record.id);
  if (!committed.ok()) return StoreFailure(committed);
  if (!acceptance.refused.ok()) return acceptance.refused;
  if (job != nullptr) StartNewRun(std::move(job), acceptance.record, checked);
  Failpoint("create.before_answer");
  return Answer(caller, acceptance);
}

void JobBook::StartNewRun(std::shared_ptr<Job> job, const JobRecord& record,
                          const CheckedSpec& checked) {
  RunRequest run;
  run.spec = checked.spec;
  run.finished.assign(static_cast<size_t>(record.points), false);
  StartRun(std::move(job), record, std::move(run));
}

// The job's present state. If the job was deleted meanwhile, its state when it was found.
absl::StatusOr<v1::EnsembleJob> JobBook::Answer(const Principal& caller,
                                                const Acceptance& acceptance) {
  const JobRecord& record = acceptance.earlier.value_or(acceptance.record);
  absl::StatusOr<v1::EnsembleJob> job = Get(caller, record.id);
  if (absl::IsNotFound(job.status())) job = Message(record, nullptr);
  if (!job.ok()) return job.status();
  // A cancellation or a new priority that came before the run was added did not find it.
  if (job->state() == v1::EnsembleJob::CANCELLING) scheduler_.Cancel(record.sequence);
  scheduler_.SetPriority(record.sequence, job->priority());
  job->set_answered_from_store(acceptance.answered_from_store);
  return job;
}

std::shared_ptr<Job> JobBook::InBook(const std::string& id) const {
  MutexLock lock(mutex_);
  const auto found = active_.find(id);
  return found != active_.end() ? found->second : nullptr;
}

absl::StatusOr<JobRecord> JobBook::ReadRecord(const Principal& caller, const std::string& id,
                                              Grid grid) {
  std::optional<JobRecord> record;
  const absl::Status read = store_.Read([&](Database& database) {
    auto found = FindJob(database, id, grid);
    if (found.ok()) record = *std::move(found);
    return found.status();
  });
  if (!read.ok()) return StoreFailure(read);
  if (!record || !caller.MaySee(record->principal)) return JobNotFound(JobName(id));
  return *std::move(record);
}

absl::StatusOr<FoundJob> JobBook::Find(const Principal& caller, const std::string& id, Grid grid) {
  absl::StatusOr<JobRecord> record = ReadRecord(caller, id, grid);
  if (!record.ok()) return record.status();
  if (HasEnded(record->state)) return FoundJob{.record = *std::move(record)};
  if (std::shared_ptr<Job> job = InBook(id)) {
    return FoundJob{.record = *std::move(record), .active = std::move(job)};
  }
  record = ReadRecord(caller, id, grid);  // it has ended since the first read
  if (!record.ok()) return record.status();
  return FoundJob{.record = *std::move(record)};
}

absl::StatusOr<v1::EnsembleJob> JobBook::Get(const Principal& caller, const std::string& id,
                                             Grid grid) {
  const absl::StatusOr<FoundJob> found = Find(caller, id, grid);
  if (!found.ok()) return found.status();
  return Message(found->record, found->active.get());
}

v1::EnsembleJob JobBook::Message(const JobRecord& record, const Job* active) const {
  if (active == nullptr) return JobMessage(record, nullptr, limits_.retain_days);
  const LiveNumbers numbers = active->Numbers();
  return JobMessage(record, &numbers, limits_.retain_days);
}

absl::StatusOr<JobRecord> JobBook::ReadRecordWithResults(const Principal& caller,
                                                         const std::string& id) {
  absl::StatusOr<JobRecord> record = ReadRecord(caller, id, Grid::kIncluded);
  if (record.ok() && record->expired_time) return ResultsExpired(JobName(id));
  return record;
}

absl::StatusOr<JobsPage> JobBook::List(const Principal& caller, const JobsQuery& query) {
  const bool everybodys = caller.role == Role::kAdmin;
  PageOfRecords records(query);
  const absl::Status read = store_.Read([&](Database& database) {
    return ReadJobs(database, everybodys ? std::nullopt : std::optional(caller.name), query.before,
                    query.grid, [&](JobRecord record) { return records.Take(std::move(record)); });
  });
  if (!read.ok()) return StoreFailure(read);
  JobsPage page{.jobs = {}, .next_before = records.next_before()};
  for (const JobRecord& record : records.records()) {
    const std::shared_ptr<Job> active = HasEnded(record.state) ? nullptr : InBook(record.id);
    const bool has_ended_since = !HasEnded(record.state) && active == nullptr;
    if (!has_ended_since) {
      page.jobs.push_back(Message(record, active.get()));
      continue;
    }
    const absl::StatusOr<JobRecord> ended = ReadRecord(caller, record.id, query.grid);
    if (absl::IsNotFound(ended.status())) continue;  // and was deleted
    if (!ended.ok()) return ended.status();
    if (query.filter.MatchesState(ended->state)) page.jobs.push_back(Message(*ended, nullptr));
  }
  return page;
}

absl::StatusOr<v1::EnsembleJob> JobBook::Cancel(const Principal& caller, const std::string& id,
                                                const std::string& request_id) {
  std::optional<JobRecord> record;
  bool begun = false;
  const absl::Status committed = store_.Commit([&](Database& database) -> absl::Status {
    begun = false;
    auto found = FindJobOf(database, caller, id);
    if (!found.ok()) return found.status();
    record = *std::move(found);
    if (!record) return absl::OkStatus();
    const auto changed = BeginCancellation(database, record->sequence, request_id);
    begun = changed.ok() && *changed;
    Failpoint("cancel.in_transaction");
    return changed.status();
  });
  if (!committed.ok()) return StoreFailure(committed);
  if (!record) return JobNotFound(JobName(id));
  Failpoint("cancel.committed");
  if (begun) CancelRun(*record);
  // An earlier call may have come before the run was added.
  if (record->state == v1::EnsembleJob::CANCELLING) scheduler_.Cancel(record->sequence);
  const bool replay = !request_id.empty() && record->cancel_request_id == request_id;
  if (begun || replay || record->state == v1::EnsembleJob::CANCELLING) return Get(caller, id);
  return JobAlreadyEnded(JobName(id), v1::EnsembleJob::State_Name(record->state));
}

void JobBook::CancelRun(const JobRecord& record) {
  if (const std::shared_ptr<Job> job = InBook(record.id)) {
    LogState(*job, v1::EnsembleJob::CANCELLING);
    job->NoteStateChange();
  }
  scheduler_.Cancel(record.sequence);
}

absl::Status JobBook::Delete(const Principal& caller, const std::string& id) {
  std::optional<JobRecord> record;
  const absl::Status committed = store_.CommitDeletion([&](Database& database) -> absl::Status {
    auto found = FindJobOf(database, caller, id);
    if (!found.ok()) return found.status();
    record = *std::move(found);
    if (!record || !HasEnded(record->state)) return absl::OkStatus();
    const absl::Status deleted = DeleteJob(database, record->sequence);
    Failpoint("delete.in_transaction");
    return deleted;
  });
  Failpoint("delete.committed");
  if (!committed.ok()) return StoreFailure(committed);
  if (!record) return JobNotFound(JobName(id));
  if (!HasEnded(record->state))
    return JobStillActive(JobName(id), v1::EnsembleJob::State_Name(record->state));
  return absl::OkStatus();
}

absl::StatusOr<v1::EnsembleJob> JobBook::Update(const Principal& caller, const std::string& id,
                                                const JobChange& change) {
  std::optional<JobRecord> record;
  bool has_expired = false;
  const absl::Status committed = store_.Commit([&](Database& database) -> absl::Status {
    auto found = FindJobOf(database, caller, id);
    if (!found.ok()) return found.status();
    record = *std::move(found);
    has_expired = change.pinned && record && record->expired_time;
    if (!record || has_expired) return absl::OkStatus();
    record->pinned = change.pinned.value_or(record->pinned);
    record->priority = change.priority.value_or(record->priority);
    return UpdateJob(database, *record);
  });
  if (!committed.ok()) return StoreFailure(committed);
  if (!record) return JobNotFound(JobName(id));
  if (has_expired) return ResultsExpired(JobName(id));
  scheduler_.SetPriority(record->sequence, record->priority);
  return Get(caller, id);
}

absl::StatusOr<v1::PointResult> JobBook::Result(const Principal& caller, const std::string& id,
                                                int64_t point) {
  absl::StatusOr<ResultsPage> page = Results(caller, id, {.first_point = point, .max_points = 1});
  if (!page.ok()) return page.status();
  if (page->points.empty() || page->points.front().index() != point) {
    return ResultNotFound(ResultName(id, point));
  }
  return std::move(page->points.front());
}

absl::StatusOr<std::optional<v1::PointResult>> JobBook::UnfinishedResult(const Principal& caller,
                                                                         const std::string& id,
                                                                         int64_t point) {
  const absl::StatusOr<FoundJob> found = Find(caller, id, Grid::kLeftOut);
  if (!found.ok()) return found.status();
  if (found->active == nullptr) return std::nullopt;
  const absl::StatusOr<v1::EnsembleSpec> spec = SpecFromBytes(found->record.spec);
  if (!spec.ok()) return StoreFailure(spec.status());
  const ExperimentKind* const experiment =
      FindExperiment(static_cast<uint64_t>(spec->experiment()));
  if (experiment == nullptr) return std::nullopt;  // an experiment of a test
  const auto live = scheduler_.Unfinished(found->record.sequence, static_cast<size_t>(point));
  if (!live) return std::nullopt;
  const CrashRecord::Examining examining(*crashes_, RunOf(found->record));
  const PointSummary summary = live->experiment->Summarize(live->merged);
  return WithDetails(ResultOf(live->index, *live->experiment, summary), DetailsOf(summary),
                     *experiment);
}

// The results may be removed while they are read. Then the job has expired or is gone when its
// record is read again.
absl::StatusOr<ResultsPage> JobBook::Results(const Principal& caller, const std::string& id,
                                             const ResultsQuery& query) {
  const absl::StatusOr<JobRecord> record = ReadRecordWithResults(caller, id);
  if (!record.ok()) return record.status();
  const absl::StatusOr<v1::EnsembleSpec> spec = SpecFromBytes(record->spec);
  if (!spec.ok()) return StoreFailure(spec.status());
  const ExperimentKind* const experiment =
      FindExperiment(static_cast<uint64_t>(spec->experiment()));
  if (experiment == nullptr) return StoreFailure(absl::DataLossError("the experiment is unknown"));
  ResultsPage page;
  size_t bytes = 0;
  absl::Status parsed;
  const auto take = [&](PointRow row) {
    absl::StatusOr<v1::PointResult> result = ResultFromBytes(row.result);
    parsed = result.status();
    if (!parsed.ok()) return false;
    const absl::StatusOr<v1::PointResult> details = DetailsFromBytes(row.details);
    parsed = details.status();
    if (!parsed.ok()) return false;
    v1::PointResult message = WithDetails(*std::move(result), *details, *experiment);
    bytes += message.ByteSizeLong();
    const bool full = page.points.size() == static_cast<size_t>(query.max_points);
    const bool ends = full || (!page.points.empty() && bytes > query.max_bytes);
    if (ends) page.next_point = row.point;
    if (!ends) page.points.push_back(std::move(message));
    return !ends;
  };
  const absl::Status read = store_.Read([&](Database& database) {
    const Details details = query.histograms ? Details::kIncluded : Details::kLeftOut;
    return ReadResults(database, record->sequence, query.first_point, details, take);
  });
  if (!read.ok()) return StoreFailure(read);
  if (!parsed.ok()) return StoreFailure(parsed);
  const absl::StatusOr<JobRecord> still = ReadRecordWithResults(caller, id);
  if (!still.ok()) return still.status();
  return page;
}

absl::StatusOr<WatchedJob> JobBook::FindWatched(const Principal& caller, const std::string& id) {
  absl::StatusOr<FoundJob> found = Find(caller, id, Grid::kLeftOut);
  if (!found.ok()) return found.status();
  WatchedJob watched{*std::move(found)};
  if (watched.active != nullptr) {
    watched.active->stored().Drop();  // it may be older than what another method has returned
    watched.last_finished = watched.active->last_finished();
    return watched;
  }
  if (watched.record.expired_time) return watched;
  const absl::Status read = store_.Read([&](Database& database) {
    const auto last = LastResultNumber(database, watched.record.sequence);
    watched.last_finished = last.value_or(0);
    return last.status();
  });
  if (!read.ok()) return StoreFailure(read);
  return watched;
}

absl::StatusOr<std::shared_ptr<const StoredJob>> JobBook::Stored(Job& job) {
  const auto read_row = [&]() -> absl::StatusOr<StoredJob> {
    StoredJob stored;
    stored.change = job.last_state_change();  // before the row, which may be newer
    std::optional<JobRecord> record;
    const absl::Status read = store_.Read([&](Database& database) {
      auto found = FindJobBySequence(database, job.sequence(), Grid::kLeftOut);
      if (found.ok()) record = *std::move(found);
      return found.status();
    });
    if (!read.ok()) return StoreFailure(read);
    if (!record) return JobNotFound(JobName(job.id()));
    stored.record = *std::move(record);
    return stored;
  };
  return job.stored().Get(job.last_state_change(), std::chrono::milliseconds(0), read_row);
}

std::shared_ptr<const JobSnapshot> JobBook::Snapshot(Job& job, std::chrono::milliseconds max_age,
                                                     size_t limit) const {
  const auto snapshot =
      job.snapshot().Get(job.last_change(), max_age, [&]() -> absl::StatusOr<JobSnapshot> {
        const CrashRecord::Examining examining(*crashes_, RunOf(job));
        JobSnapshot snapshot;
        snapshot.change = job.last_change();  // read before the points, which may be newer
        snapshot.finished = job.last_finished();
        for (const LivePoint& point : scheduler_.ChangedSince(job.sequence(), 0, limit)) {
          snapshot.points.push_back(
              {point.version, ResultOf(point.index, *point.experiment,
                                       point.experiment->Summarize(point.merged))});
        }
        return snapshot;
      });
  return *snapshot;
}

absl::StatusOr<std::vector<FinishedPoint>> JobBook::FinishedAfter(int64_t sequence,
                                                                  const Job* active, int64_t after,
                                                                  size_t limit) {
  if (active != nullptr) {
    if (auto recent = active->FinishedAfter(after, limit)) return *std::move(recent);
  }
  std::vector<FinishedPoint> points;
  size_t bytes = 0;
  const auto take = [&](int64_t number, const PointRow& row) {
    // A point that the job does not have yet would give a token that the job does not know.
    if (active != nullptr && number > active->last_finished()) return false;
    bytes += row.result.size();
    points.push_back({number, std::make_shared<const std::string>(row.result)});
    return points.size() < limit && bytes < kMaxBytesOfPoints;
  };
  const absl::Status read = store_.Read(
      [&](Database& database) { return ReadResultsStoredAfter(database, sequence, after, take); });
  if (!read.ok()) return StoreFailure(read);
  return points;
}

// ---- limits ----

void JobBook::KeepLimits(absl::Time now) {
  const absl::Status kept = retention_.Enforce(now);
  const bool is_new = std::exchange(limits_failure_, kept) != kept;
  if (is_new && !kept.ok() && !store_.failing()) {
    LogError(absl::StrCat("the limits on stored results cannot be enforced: ", kept.message()));
  }
}

int64_t JobBook::CountExpiring(absl::Time now) {
  if (limits_.retain_days == 0) return 0;
  int64_t jobs = 0;
  store_
      .Read([&](Database& database) {
        const absl::Time ended = now + kSoonToExpire - absl::Hours(24) * limits_.retain_days;
        const absl::StatusOr<int64_t> count = CountExpirable(database, ended);
        jobs = count.value_or(0);
        return count.status();
      })
      .IgnoreError();
  return jobs;
}

size_t JobBook::active_jobs() const {
  MutexLock lock(mutex_);
  return active_.size();
}

std::map<std::string, PrincipalJobs> JobBook::JobsByPrincipal() {
  std::map<std::string, PrincipalJobs> by_principal;
  store_
      .Read([&](Database& database) {
        auto counted = CountJobsByPrincipal(database);
        if (counted.ok()) by_principal = *std::move(counted);
        return counted.status();
      })
      .IgnoreError();
  return by_principal;
}

EndedJobs JobBook::ended_jobs() const {
  return {.succeeded = succeeded_, .failed = failed_, .cancelled = cancelled_};
}

}  // namespace ballpiston::server
