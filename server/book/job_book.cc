#include "server/book/job_book.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/engine_version.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "server/convert/errors.h"
#include "server/convert/timestamp.h"
#include "server/host.h"
#include "server/status/failpoint.h"
#include "server/store/job_name.h"

namespace ballpiston::server {

JobBook::JobBook(Store& store, const Limits& limits, Scheduler& scheduler,
                 std::shared_ptr<CrashRecord> crashes)
    : store_(store),
      limits_(limits),
      scheduler_(scheduler),
      crashes_(std::move(crashes)),
      active_(store, scheduler, *crashes_) {}

JobBook::~JobBook() {
  Shutdown();
  store_.Close();  // the store's thread calls this book when it has written a job's end
}

void JobBook::Shutdown() {
  store_.StopWaiting();
  scheduler_.Shutdown();
  active_.StopWaiting();
}

JobRecord JobOf(Database& database, const Principal& caller, const std::string& id, Grid grid) {
  std::optional<JobRecord> record = FindJob(database, id, grid);
  if (record && caller.MaySee(record->job.principal())) return *std::move(record);
  database.Fail(JobNotFound(JobName(id)));
  return {};
}

// ---- new jobs ----

namespace {

// The samples of all points together that the target asks for. Returns 0 if it names no number of
// samples or collisions, or if the model takes no samples.
double SamplesOfAllPoints(const EnsembleSpec& spec) {
  if (spec.target.IsOpenEnded() || NeedsNoSamples(spec)) return 0;
  const size_t points = PointCount(spec);
  double samples = 0;
  for (size_t i = 0; i < points; ++i) {
    const ChunkPlan plan = PlanFor(spec, PointAt(spec, i));
    samples += static_cast<double>(plan.samples() - plan.warm_up());
  }
  return samples;
}

}  // namespace

Acceptance JobBook::NewAcceptance(const Principal& caller,
                                  const v1::CreateEnsembleJobRequest& request,
                                  const CheckedSpec& checked) const {
  Acceptance acceptance;
  JobRecord& record = acceptance.record;
  record.id = RandomId();
  record.request_id = request.request_id();
  record.payload = PayloadOf(request);
  record.question = QuestionOf(request.spec(), EngineVersion());
  record.family = FamilyOf(request.spec(), EngineVersion());
  v1::EnsembleJob& job = record.job;
  job.set_name(JobName(record.id));
  *job.mutable_spec() = request.spec();
  SetTime(WallNow(), job.mutable_create_time());
  job.set_engine_version(EngineVersion());
  job.set_principal(caller.name);
  job.set_priority(request.priority());
  *job.mutable_labels() = request.labels();
  job.mutable_progress()->set_points(static_cast<int32_t>(PointCount(checked.spec)));
  SetNumbers({.bytes = BytesOfJob(job)}, job);
  acceptance.fresh = request.fresh();
  acceptance.samples = SamplesOfAllPoints(checked.spec);
  acceptance.violations = checked.violations;
  if (limits_.max_store_bytes > 0) acceptance.active_bytes = active_.bytes();
  return acceptance;
}

absl::StatusOr<v1::EnsembleJob> JobBook::Create(const Principal& caller,
                                                const v1::CreateEnsembleJobRequest& request,
                                                const CheckedSpec& checked) {
  Acceptance acceptance = NewAcceptance(caller, request, checked);
  RunRequest run;  // made before the commit, because it may take much memory
  run.spec = checked.spec;
  run.finished.assign(PointCount(run.spec), false);
  std::shared_ptr<Job> job;  // the new job, if there is one
  const auto earlier = store_.Commit([&](Database& database) {
    auto found = Accept(database, limits_, acceptance);
    Failpoint("create.in_transaction");
    job = found ? nullptr : active_.Add(acceptance.record);
    return found;
  });
  Failpoint("create.committed");
  if (!earlier.ok() || *earlier) active_.Remove(acceptance.record.id);
  if (!earlier.ok()) return StoreFailure(earlier.status());
  if (*earlier) return Answer(caller, **earlier);
  run.has_checkpoints = !job->row().job.continues().empty();
  active_.StartRun(job, std::move(run));
  Failpoint("create.before_answer");
  return Answer(caller, acceptance.record);
}

// Tells the scheduler the job's present state, and returns it. The row is read again, because
// another call may have changed it since the caller's commit. If the job was deleted meanwhile,
// returns `record`.
absl::StatusOr<v1::EnsembleJob> JobBook::Answer(const Principal& caller, const JobRecord& record) {
  absl::StatusOr<FoundJob> found;
  {
    MutexLock lock(telling_);
    found = Find(caller, record.id, Grid::kIncluded);
    if (absl::IsNotFound(found.status())) found = FoundJob{record};
    TellScheduler(found.ok() ? found->record : record);
  }
  if (!found.ok()) return found.status();
  v1::EnsembleJob job = Message(found->record, found->active.get());
  job.set_answered_from_store(record.job.answered_from_store());
  return job;
}

// Passes on the two changes that a client can make to a run: it is cancelled, or its priority
// changes.
void JobBook::TellScheduler(const JobRecord& row) {
  if (row.job.state() == v1::EnsembleJob::CANCELLING) scheduler_.Cancel(row.sequence);
  scheduler_.SetPriority(row.sequence, row.job.priority());
}

// ---- changes of a job ----

absl::StatusOr<v1::EnsembleJob> JobBook::Cancel(const Principal& caller, const std::string& id,
                                                const std::string& request_id) {
  bool begun = false;
  const auto found = store_.Commit([&](Database& database) {
    JobRecord record = JobOf(database, caller, id, Grid::kLeftOut);
    const std::string& owner = record.job.principal();
    const auto other = FindJobOfCancellation(database, owner, request_id);
    if ((other && other->sequence != record.sequence) ||
        FindJobOfRequest(database, owner, request_id)) {
      database.Fail(RequestIdReused(request_id));
      return record;
    }
    begun = BeginCancellation(database, record, request_id);
    Failpoint("cancel.in_transaction");
    const JobState state = record.job.state();
    // Also several cancellations that were accepted at the same time can be retried.
    const bool is_retry = !request_id.empty() && state == v1::EnsembleJob::CANCELLED;
    if (HasEnded(state) && !is_retry) {
      database.Fail(JobAlreadyEnded(JobName(id), v1::EnsembleJob::State_Name(state)));
    }
    return record;
  });
  if (!found.ok()) return StoreFailure(found.status());
  Failpoint("cancel.committed");
  const std::shared_ptr<Job> job = active_.Find(id);
  if (begun && job != nullptr) job->NoteStateChange();
  return Answer(caller, *found);
}

absl::Status JobBook::Delete(const Principal& caller, const std::string& id) {
  const absl::Status deleted = store_.CommitDeletion([&](Database& database) {
    const JobRecord record = JobOf(database, caller, id, Grid::kLeftOut);
    const JobState state = record.job.state();
    if (!HasEnded(state)) {
      database.Fail(JobStillActive(JobName(id), v1::EnsembleJob::State_Name(state)));
    }
    DeleteJob(database, record.sequence);
    Failpoint("delete.in_transaction");
  });
  Failpoint("delete.committed");
  return StoreFailure(deleted);
}

namespace {

// Refuses to pin the job, which takes `bytes`, if its principal's pinned jobs would then take more
// than half of the store, which has to have room for others.
void CheckPin(Database& database, const Limits& limits, const v1::EnsembleJob& job, int64_t bytes) {
  const int64_t most = limits.max_store_bytes / 2;
  if (most == 0) return;
  const int64_t pinned = PinnedBytes(database, job.principal()) + bytes;
  if (pinned <= most) return;
  database.Fail(
      LimitExceeded("TOO_MANY_PINNED_BYTES",
                    absl::StrCat(job.principal(), "'s pinned jobs would take ", pinned,
                                 " bytes with this one, more than half of the store: unpin some"),
                    "max-store-bytes", static_cast<double>(most)));
}

}  // namespace

absl::StatusOr<v1::EnsembleJob> JobBook::Update(const Principal& caller, const std::string& id,
                                                const JobChange& change) {
  JobRecord record;
  const absl::Status changed = store_.Commit([&](Database& database) {
    record = JobOf(database, caller, id, Grid::kLeftOut);
    v1::EnsembleJob& job = record.job;
    if (change.pinned && job.results_expired()) database.Fail(ResultsExpired(JobName(id)));
    const bool is_new_pin = change.pinned.value_or(false) && !job.pinned();
    if (is_new_pin && caller.role != Role::kAdmin) {
      const std::shared_ptr<Job> active = active_.Find(id);
      CheckPin(database, limits_, job, active ? active->Numbers().bytes : StoredBytesOf(job));
    }
    job.set_pinned(change.pinned.value_or(job.pinned()));
    job.set_priority(change.priority.value_or(job.priority()));
    if (change.labels) *job.mutable_labels() = {change.labels->begin(), change.labels->end()};
    UpdateJob(database, record);
  });
  if (!changed.ok()) return StoreFailure(changed);
  return Answer(caller, record);
}

std::vector<v1::PrincipalStatus> JobBook::JobsByPrincipal() {
  return store_.Read(&CountJobsByPrincipal).value_or(std::vector<v1::PrincipalStatus>());
}

}  // namespace ballpiston::server
