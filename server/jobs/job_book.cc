#include "server/jobs/job_book.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "server/convert/result_record.h"
#include "server/jobs/acceptance.h"
#include "server/jobs/job_journal.h"
#include "server/jobs/job_message.h"
#include "server/jobs/job_name.h"
#include "server/jobs/job_state.h"
#include "server/jobs/question.h"
#include "server/observability/failpoint.h"
#include "server/observability/log.h"
#include "server/security/sha256.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"
#include "server/store/usage_table.h"

namespace ballpiston::server {
namespace {

// Finished points are read until they have this many bytes.
constexpr size_t kMaxBytesOfPoints = size_t{512} << 10;

// How often processor time is stored. If the server is killed, the time since it was last stored
// does not count for the quota.
constexpr absl::Duration kBetweenWork = absl::Minutes(1);

// The latest time that a Timestamp can hold.
constexpr absl::Time kLastTime = absl::FromUnixSeconds(253'402'300'799);

// Upper bound of the encoded size of the job's message: names, times and numbers take less than
// the constant.
size_t MostBytesOf(const JobRecord& record, bool grids) {
  return 512 + record.principal.size() + record.engine_version.size() +
         (grids ? record.spec.size() : 0) + record.error.size();
}

// Collects the records of one page, newest first, until one of the query's bounds is reached.
class PageOfRecords {
 public:
  explicit PageOfRecords(const JobsQuery& query) : query_(query) {}

  // False: the page ends before this record.
  bool Take(JobRecord record) {
    const size_t bytes = MostBytesOf(record, query_.grids);
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
  auto found = FindJob(database, id);
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
    const absl::StatusOr<storage::Result> result = ResultFromBytes(row.result);
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

RunName RunOf(const Job& job) { return {job.sequence(), GenerationOf(job.id(), job.restarts())}; }

std::string Text(const std::set<size_t>& points) {
  return points.empty() ? "" : absl::StrJoin(points, " ");
}

void LogCrashed(const JobRecord& job, const std::string& points, const v1::EnsembleSpec& spec) {
  Log(Severity::kError,
      "the engine crashed again and again while it computed this job, which fails",
      {{"job", JobName(job.id)},
       {"principal", job.principal},
       {"points", points},
       {"question", spec.ShortDebugString()}});
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
                 std::function<void()> on_state_change, std::shared_ptr<CrashRecord> crashes)
    : store_(store),
      limits_(limits),
      scheduler_(scheduler),
      on_state_change_(std::move(on_state_change)),
      crashes_(std::move(crashes)),
      retention_(store, usage_, limits) {}

JobBook::~JobBook() {
  Shutdown();
  store_.Flush().IgnoreError();  // after this, this book knows every ended job
  StoreNewWork(absl::Now());
}

void JobBook::Shutdown() {
  store_.StopWaiting();
  scheduler_.Shutdown();
}

// ---- resuming jobs of an earlier process ----

absl::Status JobBook::Resume() {
  const absl::Status known = ReadUsage();
  if (!known.ok()) return known;
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
  for (JobRecord& record : *unfinished) {
    const absl::Status resumed = ResumeJob(std::move(record));
    Failpoint("resume.job");
    if (!resumed.ok()) return resumed;
  }
  return store_.Flush();
}

absl::Status JobBook::ReadUsage() {
  return store_.Read([&](Database& database) {
    const auto stored = ReadStoredUsage(database);
    if (!stored.ok()) return stored.status();
    for (const StoredUsage& usage : *stored) {
      usage_.AddStored(usage.principal, usage.jobs, usage.bytes);
    }
    const auto work = ReadWork(database, Usage::FirstDay(absl::Now()));
    if (!work.ok()) return work.status();
    for (const DayOfWork& day : *work) usage_.AddStoredWork(day);
    return absl::OkStatus();
  });
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

absl::Status JobBook::ResumeJob(JobRecord record) {
  if (record.state == v1::EnsembleJob::CANCELLING) {
    return EndUnresumable(record, absl::CancelledError("cancelled"));
  }
  const CrashRecord::Examining examining(*crashes_, RunOf(record));
  if (crashes_->Deaths(RunOf(record)) >= kMostDeaths) return EndCrashed(record);
  const absl::StatusOr<v1::EnsembleSpec> message = SpecFromBytes(record.spec);
  if (!message.ok()) return EndUnresumable(record, message.status());
  CheckedSpec checked = CheckSpec(*message);
  if (!checked.violations.empty()) return EndUnresumable(record, InvalidSpec(checked.violations));
  return ResumeRun(std::move(record), std::move(checked.spec));
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
  auto job = std::make_shared<Job>(record, nullptr);
  job->AddRestoredPoints(points.count(), points.samples, points.last);
  AddRestoredBytes(*job, points.bytes);
  JobJournal(job, store_, usage_, true, nullptr).Ended(why);
  return absl::OkStatus();
}

absl::Status JobBook::ResumeRun(JobRecord record, EnsembleSpec spec) {
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
  std::shared_ptr<Job> job = Register(std::move(record));
  job->AddRestoredPoints(points.count(), points.samples, points.last);
  AddRestoredBytes(*job, points.bytes);
  StartRun(std::move(job), std::move(request));
  return absl::OkStatus();
}

void JobBook::AddRestoredBytes(Job& job, int64_t bytes) {
  job.AddBytes(bytes);
  usage_.AddStored(job.principal(), 0, bytes);
}

std::shared_ptr<Job> JobBook::Register(JobRecord record) {
  active_points_.Add(record.id, record.principal, record.points);
  auto job = std::make_shared<Job>(std::move(record), on_state_change_);
  MutexLock lock(mutex_);
  active_.emplace(job->id(), job);
  return job;
}

void JobBook::StartRun(std::shared_ptr<Job> job, RunRequest request) {
  request.key = job->sequence();
  request.generation = RunOf(*job).generation;
  request.principal = job->principal();
  request.priority = job->Record().priority;
  request.journal =
      std::make_shared<JobJournal>(std::move(job), store_, usage_, request.has_checkpoints,
                                   [this](const Job& ended) { Forget(ended); });
  scheduler_.Add(std::move(request));
}

void JobBook::Forget(const Job& ended) {
  const JobState state = ended.state();
  const JobRecord record = ended.Record();
  if (absl::StrContains(record.error, kEngineCrashed)) {
    LogCrashed(record, "", ended.Now().job.spec());
  }
  ++(state == v1::EnsembleJob::SUCCEEDED ? succeeded_
     : state == v1::EnsembleJob::FAILED  ? failed_
                                         : cancelled_);
  active_points_.Remove(ended.id());
  MutexLock lock(mutex_);
  active_.erase(ended.id());
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
  record.bytes = static_cast<int64_t>(record.spec.size());
  record.create_time = absl::Now();
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
  const absl::Status read = store_.Read([&](Database& database) {
    return Judge(database, limits_, active_points_, usage_, acceptance);
  });
  if (!read.ok()) return StoreFailure(read);
  if (!acceptance.refused.ok()) return acceptance.refused;
  return acceptance.earlier ? EarlierJob(caller, acceptance) : JobMessage(acceptance.record);
}

absl::StatusOr<v1::EnsembleJob> JobBook::Create(const Principal& caller,
                                                const v1::CreateEnsembleJobRequest& request,
                                                const CheckedSpec& checked) {
  Acceptance acceptance = NewAcceptance(caller, request, checked);
  acceptance.record.id = RandomId();
  const auto accept = [&](Database& database) {
    const absl::Status accepted = Accept(database, limits_, active_points_, usage_, acceptance);
    Failpoint("create.in_transaction");
    return accepted;
  };
  // The job is registered before another call can see it in the store.
  std::shared_ptr<Job> job;
  const absl::Status committed = store_.Commit(accept, [&](const absl::Status& done) {
    Failpoint("create.committed");
    if (!done.ok()) active_points_.Remove(acceptance.record.id);
    if (!done.ok() || acceptance.earlier || !acceptance.refused.ok()) return;
    usage_.AddStored(caller.name, 1, acceptance.record.bytes);
    job = Register(acceptance.record);
    RunRequest run;
    run.spec = checked.spec;
    run.finished.assign(static_cast<size_t>(acceptance.record.points), false);
    StartRun(job, std::move(run));
  });
  if (!committed.ok()) return StoreFailure(committed);
  Failpoint("create.before_answer");
  if (!acceptance.refused.ok()) return acceptance.refused;
  return acceptance.earlier ? EarlierJob(caller, acceptance) : Now(*job).job;
}

// The job's present state. If the job was deleted meanwhile, its state when it was found.
absl::StatusOr<v1::EnsembleJob> JobBook::EarlierJob(const Principal& caller,
                                                    const Acceptance& acceptance) {
  absl::StatusOr<v1::EnsembleJob> job = Get(caller, acceptance.earlier->id);
  if (absl::IsNotFound(job.status())) job = Message(*acceptance.earlier);
  if (job.ok()) job->set_answered_from_store(acceptance.answered_from_store);
  return job;
}

std::shared_ptr<Job> JobBook::ActiveOrNull(const Principal& caller, const std::string& id) const {
  MutexLock lock(mutex_);
  const auto found = active_.find(id);
  const bool seen = found != active_.end() && caller.MaySee(found->second->principal());
  return seen ? found->second : nullptr;
}

absl::StatusOr<JobRecord> JobBook::ReadRecord(const Principal& caller, const std::string& id) {
  std::optional<JobRecord> record;
  const absl::Status read = store_.Read([&](Database& database) {
    auto found = FindJob(database, id);
    if (found.ok()) record = *std::move(found);
    return found.status();
  });
  if (!read.ok()) return StoreFailure(read);
  if (!record || !caller.MaySee(record->principal)) return JobNotFound(JobName(id));
  return *std::move(record);
}

absl::StatusOr<v1::EnsembleJob> JobBook::Get(const Principal& caller, const std::string& id) {
  // In this order: a job leaves the book only when its end is in the store.
  if (const std::shared_ptr<Job> job = ActiveOrNull(caller, id)) return Now(*job).job;
  const absl::StatusOr<JobRecord> record = ReadRecord(caller, id);
  if (!record.ok()) return record.status();
  return Message(*record);
}

Job::View JobBook::Now(const Job& job) const {
  const JobRecord before = job.Record();
  Job::View view = job.Now();
  AddExpireTime(before, view.job);
  return view;
}

v1::EnsembleJob JobBook::Message(const JobRecord& record) const {
  v1::EnsembleJob job = JobMessage(record);
  AddExpireTime(record, job);
  return job;
}

void JobBook::AddExpireTime(const JobRecord& record, v1::EnsembleJob& job) const {
  const bool may_expire = record.end_time && !record.expired_time && !record.pinned;
  if (limits_.retain_days == 0 || !may_expire) return;
  const absl::Time expires = *record.end_time + absl::Hours(24) * limits_.retain_days;
  SetTime(std::min(expires, kLastTime), job.mutable_expire_time());
}

absl::StatusOr<JobRecord> JobBook::ReadRecordWithResults(const Principal& caller,
                                                         const std::string& id) {
  absl::StatusOr<JobRecord> record = ReadRecord(caller, id);
  if (record.ok() && record->expired_time) return ResultsExpired(JobName(id));
  return record;
}

absl::StatusOr<JobsPage> JobBook::List(const Principal& caller, const JobsQuery& query) {
  const bool everybodys = caller.role == Role::kAdmin;
  PageOfRecords records(query);
  const absl::Status read = store_.Read([&](Database& database) {
    return ReadJobs(database, everybodys ? std::nullopt : std::optional(caller.name), query.before,
                    [&](JobRecord record) { return records.Take(std::move(record)); });
  });
  if (!read.ok()) return StoreFailure(read);
  JobsPage page{.jobs = {}, .next_before = records.next_before()};
  for (const JobRecord& record : records.records()) {
    // The store does not have the progress of an active job.
    absl::StatusOr<v1::EnsembleJob> job =
        HasEnded(record.state) ? Message(record) : Get(caller, record.id);
    if (absl::IsNotFound(job.status())) continue;  // the job was deleted meanwhile
    if (!job.ok()) return job.status();
    if (!query.filter.MatchesState(job->state())) continue;  // the state has changed since the read
    if (!query.grids) job->mutable_spec()->clear_grid();
    page.jobs.push_back(*std::move(job));
  }
  return page;
}

absl::StatusOr<v1::EnsembleJob> JobBook::Cancel(const Principal& caller, const std::string& id,
                                                const std::string& request_id) {
  std::optional<JobRecord> record;
  bool begun = false;
  const auto begin = [&](Database& database) -> absl::Status {
    begun = false;
    auto found = FindJobOf(database, caller, id);
    if (!found.ok()) return found.status();
    record = *std::move(found);
    if (!record) return absl::OkStatus();
    const auto changed = BeginCancellation(database, record->sequence, request_id);
    begun = changed.ok() && *changed;
    Failpoint("cancel.in_transaction");
    return changed.status();
  };
  const absl::Status committed = store_.Commit(begin, [&](const absl::Status& done) {
    const std::shared_ptr<Job> job = ActiveOrNull(caller, id);
    if (done.ok() && begun && job) job->Enter(v1::EnsembleJob::CANCELLING, absl::Now());
  });
  if (!committed.ok()) return StoreFailure(committed);
  if (!record) return JobNotFound(JobName(id));
  Failpoint("cancel.committed");
  if (begun) scheduler_.Cancel(record->sequence);
  const bool replay = !request_id.empty() && record->cancel_request_id == request_id;
  if (begun || replay || record->state == v1::EnsembleJob::CANCELLING) return Get(caller, id);
  return JobAlreadyEnded(JobName(id), StateName(record->state));
}

absl::Status JobBook::Delete(const Principal& caller, const std::string& id) {
  std::optional<JobRecord> record;
  const auto drop = [&](Database& database) -> absl::Status {
    auto found = FindJobOf(database, caller, id);
    if (!found.ok()) return found.status();
    record = *std::move(found);
    if (!record || !HasEnded(record->state)) return absl::OkStatus();
    const absl::Status deleted = DeleteJob(database, record->sequence);
    Failpoint("delete.in_transaction");
    return deleted;
  };
  const absl::Status committed = store_.CommitDeletion(drop, [&](const absl::Status& done) {
    const bool deleted = done.ok() && record && HasEnded(record->state);
    if (deleted) usage_.AddStored(record->principal, -1, -record->bytes);
  });
  Failpoint("delete.committed");
  if (!committed.ok()) return StoreFailure(committed);
  if (!record) return JobNotFound(JobName(id));
  if (HasEnded(record->state)) return absl::OkStatus();
  const std::shared_ptr<Job> job = ActiveOrNull(caller, id);
  return JobStillActive(JobName(id), StateName(job ? job->state() : record->state));
}

absl::StatusOr<v1::EnsembleJob> JobBook::Pin(const Principal& caller, const std::string& id,
                                             bool pinned) {
  std::optional<JobRecord> record;
  const auto pin = [&](Database& database) -> absl::Status {
    auto found = FindJobOf(database, caller, id);
    if (!found.ok()) return found.status();
    record = *std::move(found);
    if (!record || record->expired_time) return absl::OkStatus();
    return PinJob(database, record->sequence, pinned);
  };
  const absl::Status committed = store_.Commit(pin, [&](const absl::Status& done) {
    const std::shared_ptr<Job> job = ActiveOrNull(caller, id);
    if (done.ok() && job) job->SetPinned(pinned);
  });
  if (!committed.ok()) return StoreFailure(committed);
  if (!record) return JobNotFound(JobName(id));
  if (record->expired_time) return ResultsExpired(JobName(id));
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
  const absl::StatusOr<std::shared_ptr<Job>> job = FindActive(caller, id);
  if (!job.ok()) return job.status();
  if (*job == nullptr) return std::nullopt;
  const auto number = static_cast<uint64_t>((*job)->Now().job.spec().experiment());
  const ExperimentKind* const experiment = FindExperiment(number);
  if (experiment == nullptr) return std::nullopt;  // an experiment of a test
  const auto live = scheduler_.Unfinished((*job)->sequence(), static_cast<size_t>(point));
  if (!live) return std::nullopt;
  const CrashRecord::Examining examining(*crashes_, RunOf(**job));
  const PointSummary summary = live->experiment->Summarize(live->merged);
  return PointResultMessage(ResultRecordOf(live->index, *live->experiment, summary),
                            DetailsRecordOf(summary), *experiment);
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
    absl::StatusOr<storage::Result> result = ResultFromBytes(row.result);
    parsed = result.status();
    if (!parsed.ok()) return false;
    const absl::StatusOr<storage::Details> details = DetailsFromBytes(row.details);
    parsed = details.status();
    if (!parsed.ok()) return false;
    v1::PointResult message = PointResultMessage(*result, *details, *experiment);
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

absl::StatusOr<std::shared_ptr<Job>> JobBook::FindActive(const Principal& caller,
                                                         const std::string& id) {
  if (std::shared_ptr<Job> job = ActiveOrNull(caller, id)) return job;
  const absl::StatusOr<JobRecord> record = ReadRecord(caller, id);
  if (!record.ok()) return record.status();
  if (HasEnded(record->state)) return nullptr;
  // The job was committed a moment ago. It is in the book after the store's next commit.
  const absl::Status settled = store_.Flush();
  if (!settled.ok()) return StoreFailure(settled);
  return ActiveOrNull(caller, id);
}

absl::StatusOr<WatchedJob> JobBook::FindWatched(const Principal& caller, const std::string& id) {
  absl::StatusOr<std::shared_ptr<Job>> active = FindActive(caller, id);
  if (!active.ok()) return active.status();
  if (const std::shared_ptr<Job>& job = *active) {
    return WatchedJob{
        .active = job,
        .sequence = job->sequence(),
        .restarts = job->restarts(),
        .last_finished = job->last_finished(),
    };
  }
  const absl::StatusOr<JobRecord> record = ReadRecord(caller, id);
  if (!record.ok()) return record.status();
  absl::StatusOr<int64_t> last;
  const absl::Status read = store_.Read([&](Database& database) {
    last = LastResultNumber(database, record->sequence);
    return last.status();
  });
  if (!read.ok()) return StoreFailure(read);
  const bool expired = record->expired_time.has_value();
  return WatchedJob{.sequence = record->sequence,
                    .restarts = record->restarts,
                    .last_finished = expired ? 0 : *last,
                    .progress = JobMessage(*record).progress(),
                    .spec_bytes = record->spec.size(),
                    .expired = expired};
}

std::shared_ptr<const JobSnapshot> JobBook::Snapshot(Job& job, std::chrono::milliseconds max_age,
                                                     size_t limit) const {
  return job.snapshot().Get(job.last_change(), max_age, [&] {
    const CrashRecord::Examining examining(*crashes_, RunOf(job));
    JobSnapshot snapshot;
    snapshot.change = job.last_change();  // read before the points, which may be newer
    snapshot.finished = job.last_finished();
    for (const LivePoint& point : scheduler_.ChangedSince(job.sequence(), 0, limit)) {
      const storage::Result now =
          ResultRecordOf(point.index, *point.experiment, point.experiment->Summarize(point.merged));
      snapshot.points.push_back({point.version, PointResultMessage(now)});
    }
    return snapshot;
  });
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
  EndLongJobs();
  if (now >= next_work_time_) StoreNewWork(now);
  const absl::Status kept = retention_.Enforce(now);
  const bool is_new = std::exchange(limits_failure_, kept) != kept;
  if (is_new && !kept.ok() && !store_.failing()) {
    LogError(absl::StrCat("the limits on stored results cannot be enforced: ", kept.message()));
  }
}

void JobBook::EndLongJobs() {
  const double most = limits_.max_seconds_per_job;
  if (most == 0) return;
  for (const std::shared_ptr<Job>& job : ActiveJobsNow()) {
    const double work = job->Record().work;
    if (work < most) continue;
    scheduler_.Stop(job->sequence(),
                    LimitExceeded("JOB_TOO_LONG",
                                  absl::StrCat("the job has taken ", work, " s of processor time"),
                                  "max-seconds-per-job", most));
  }
}

void JobBook::StoreNewWork(absl::Time now) {
  next_work_time_ = now + kBetweenWork;
  const auto work = std::make_shared<const std::vector<DayOfWork>>(usage_.TakeNewWork(now));
  if (work->empty()) return;
  store_.Record([work, first = Usage::FirstDay(now)](Database& database) {
    for (const DayOfWork& day : *work) {
      const absl::Status added = AddWork(database, day);
      if (!added.ok()) return added;
    }
    return DropWorkBefore(database, first);
  });
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

std::vector<std::shared_ptr<Job>> JobBook::ActiveJobsNow() const {
  std::vector<std::shared_ptr<Job>> active;
  MutexLock lock(mutex_);
  active.reserve(active_.size());
  for (const auto& [id, job] : active_) active.push_back(job);
  return active;
}

std::map<std::string, ActiveJobs> JobBook::ActiveByPrincipal() const {
  std::map<std::string, ActiveJobs> by_principal;
  for (const std::shared_ptr<Job>& job : ActiveJobsNow()) {
    const JobState state = job->state();
    if (HasEnded(state)) continue;  // the book is about to remove it
    ActiveJobs& jobs = by_principal[job->principal()];
    ++(state == v1::EnsembleJob::QUEUED    ? jobs.queued
       : state == v1::EnsembleJob::RUNNING ? jobs.running
                                           : jobs.cancelling);
  }
  return by_principal;
}

EndedJobs JobBook::ended_jobs() const {
  return {.succeeded = succeeded_, .failed = failed_, .cancelled = cancelled_};
}

}  // namespace ballpiston::server
