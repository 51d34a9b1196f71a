#include "server/book/job_journal.h"

#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/errors.h"
#include "server/convert/fold_record.h"
#include "server/convert/point_result.h"
#include "server/convert/timestamp.h"
#include "server/host.h"
#include "server/status/failpoint.h"
#include "server/status/log.h"
#include "server/store/job_name.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"

namespace ballpiston::server {
namespace {

// Bytes of memory; histograms or the states of groups take most of it.
size_t BytesHeld(const BlockResult& result) {
  size_t bytes = sizeof(BlockResult);
  for (const Histogram& histogram : result.histograms) {
    bytes += histogram.counts.size() * sizeof(histogram.counts[0]);
  }
  for (const GroupState& group : result.groups) bytes += group.numbers().size_bytes();
  return bytes;
}

JobEnd EndOf(const Job& job, const absl::Status& outcome) {
  JobEnd end = {.time = WallNow(), .error = {}, .numbers = job.Numbers()};
  if (outcome.ok()) return end;
  end.state = absl::IsCancelled(outcome) ? v1::EnsembleJob::CANCELLED : v1::EnsembleJob::FAILED;
  if (end.state == v1::EnsembleJob::FAILED) {
    end.error = RpcStatus(WithDefaultReason(outcome, "COMPUTATION_FAILED"));
  }
  return end;
}

// The job fails if the store rejected one of its results, because clients could not read it.
JobEnd WithStoredPoints(Database& database, const Job& job, JobEnd end) {
  const int64_t points = job.row().job.progress().points();
  end.numbers.points_done = CountResults(database, job.row().sequence);
  if (end.state != v1::EnsembleJob::SUCCEEDED || end.numbers.points_done == points) return end;
  const absl::Status lost = absl::DataLossError(
      absl::StrCat("of ", points, " computed points the store keeps ", end.numbers.points_done));
  end.state = v1::EnsembleJob::FAILED;
  end.error = RpcStatus(StoreFailure(lost));
  return end;
}

absl::Status Rejected(const absl::Status& why) {
  if (absl::IsDataLoss(why)) return StoreFailure(why);
  return absl::InternalError(absl::StrCat("the store rejected the job's end: ", why.message()));
}

void LogCrash(const v1::EnsembleJob& job) {
  Log(Severity::kError,
      "the engine crashed again and again while it computed this job, which fails",
      {{"job", job.name()},
       {"principal", job.principal()},
       {"question", job.spec().ShortDebugString()}});
}

void LogEnd(const v1::EnsembleJob& ended) {
  const std::string state = absl::AsciiStrToLower(v1::EnsembleJob::State_Name(ended.state()));
  // A job without a start time ended before its first turn.
  const auto& begin = ended.has_start_time() ? ended.start_time() : ended.create_time();
  if (ReasonOf(ended.error()) == EngineCrashed.reason) LogCrash(ended);
  Log(ended.has_error() ? Severity::kWarning : Severity::kInfo, absl::StrCat("job ", state),
      {{"job", ended.name()},
       {"principal", ended.principal()},
       {"state", state},
       {"points", ended.progress().points_done()},
       {"samples", static_cast<int64_t>(ended.progress().samples())},
       {"processor_seconds", ended.work()},
       {"seconds", absl::ToDoubleSeconds(TimeOf(ended.end_time()) - TimeOf(begin))},
       {"error", ended.error().message()}});
}

void TellEnd(Job& job, const std::optional<JobRecord>& ended, const JobJournal::OnEnded& on_ended) {
  if (!ended) return;
  Failpoint("job.ended");
  LogEnd(ended->job);
  if (on_ended) on_ended(*ended);
  job.NoteStateChange();
}

// If the store rejects the end, the job fails, because no client may wait for ever. Then the points
// are not counted, because their table may be damaged.
void RecordEnd(Store& store, const std::shared_ptr<Job>& job, const JobJournal::OnEnded& on_ended,
               const absl::Status& outcome, bool was_rejected = false) {
  const auto ended = std::make_shared<std::optional<JobRecord>>();
  const auto change = [=, end = EndOf(*job, outcome)](Database& database) {
    *ended = EndJob(database, job->row().sequence,
                    was_rejected ? end : WithStoredPoints(database, *job, end));
  };
  store.RecordSoon(change, [=, &store](const absl::Status& done) {
    if (done.ok()) return TellEnd(*job, *ended, on_ended);
    const bool is_closed = IsOfTheDisk(done);
    if (!is_closed && !was_rejected) RecordEnd(store, job, on_ended, Rejected(done), true);
  });
}

// Empty if the job that is continued is gone, or does not have the point.
std::optional<StoredState> ReadEarlier(Database& database, const std::string& job, int64_t point) {
  const std::optional<std::string> id = JobIdOf(job);
  const std::optional<JobRecord> record =
      id ? FindJob(database, *id, Grid::kLeftOut) : std::nullopt;
  if (!record || record->job.results_expired()) return std::nullopt;
  const std::optional<PointEnd> end = ReadEnd(database, record->sequence, point);
  if (!end) return std::nullopt;
  absl::StatusOr<FoldState> state = EndFromBytes(end->state);
  if (state.ok()) return StoredState{static_cast<Model>(end->model), *std::move(state)};
  LogError(absl::StrCat("point ", point, " of ", job,
                        " cannot be continued and is computed anew: ", state.status().message()));
  return std::nullopt;
}

// Empty if no other job can continue the point.
PointEnd PointEndOf(const JobRecord& job, const PointExperiment& experiment,
                    const PointFold& fold) {
  if (job.family.empty() || experiment.plan().samples() == 0) return {};
  const std::optional<FoldState> state = fold.Continuation();
  const bool has_samples = state && (state->chunk > 0 || state->blocks > 0);
  if (!has_samples) return {};
  return {static_cast<int32_t>(experiment.answer().model), EndBytes(*state)};
}

}  // namespace

JobJournal::JobJournal(std::shared_ptr<Job> job, Store& store, bool resumed, OnEnded on_ended)
    : job_(std::move(job)), store_(store), resumed_(resumed), on_ended_(std::move(on_ended)) {}

void JobJournal::Began() {
  const auto begun = std::make_shared<bool>(false);
  const auto begin = [sequence = job_->row().sequence, now = WallNow(), begun](Database& database) {
    *begun = BeginJob(database, sequence, now);
  };
  store_.Record(begin, [job = job_, begun](const absl::Status& done) {
    if (!done.ok() || !*begun) return;
    Log(Severity::kInfo, "job running",
        {{"job", job->row().job.name()},
         {"principal", job->row().job.principal()},
         {"state", "running"}});
    job->NoteStateChange();
  });
}

absl::StatusOr<StoredPoint> JobJournal::ReadPoint(size_t point) {
  absl::StatusOr<StoredPoint> read = store_.Read([&](Database& database) {
    StoredPoint stored;
    const int64_t sequence = job_->row().sequence;
    const auto index = static_cast<int64_t>(point);
    if (const auto checkpoint = ReadCheckpoint(database, sequence, index)) {
      stored.state = database.ValueOf(CheckpointFromBytes(*checkpoint));
    }
    for (const std::string& chunk : ReadChunks(database, sequence, index)) {
      stored.chunks.push_back(database.ValueOf(ChunkFromBytes(chunk)));
    }
    if (!stored.state) stored.earlier = ReadEarlier(database, job_->row().job.continues(), index);
    return stored;
  });
  if (absl::IsUnavailable(read.status())) {
    LogError(absl::StrCat("point ", point, " of ", job_->row().job.name(),
                          " cannot be read and is read again: ", read.status().message()));
    store_.AwaitRetry();
  }
  return read;
}

uint64_t JobJournal::Merged(const MergedSamples& merged) {
  const uint64_t change = job_->Add(
      {.samples = static_cast<double>(merged.samples), .points_computed = merged.share_of_point});
  Failpoint(merged.restored ? "resume.point" : "block.merged");
  return change;
}

void JobJournal::Checkpoint(size_t point, Model model, const FoldState& state) {
  // Shared, because the store's closures must be copyable. Serialized only if it is written.
  auto copy = std::make_shared<const FoldState>(state);
  const size_t bytes = BytesHeld(copy->complete) + BytesHeld(copy->partial);
  store_.RecordCheckpoint(
      job_->row().sequence, static_cast<int64_t>(point), state.chunk,
      [copy = std::move(copy), model] { return FoldRecordBytes(*copy, model); }, bytes);
}

void JobJournal::ChunkIsEarly(size_t point, Model model, const ChunkResult& chunk) {
  store_.RecordChunk(job_->row().sequence, static_cast<int64_t>(point), chunk.chunk,
                     ChunkRecordBytes(chunk, model));
}

void JobJournal::Worked(double seconds) { job_->Add({.work = seconds}); }

void JobJournal::PointFinished(size_t point, const PointExperiment& experiment,
                               const PointFold& fold) {
  if (experiment.plan().samples() == 0) job_->Add({.points_computed = 1});  // computed without one
  const BlockResult merged = fold.Merged();
  const PointSummary summary = experiment.Summarize(merged);
  PointRow row = {static_cast<int64_t>(point), static_cast<double>(summary.samples),
                  DeterministicBytes(ResultOf(point, experiment, summary)),
                  DetailsBytes(DetailsOf(summary))};
  row.end = PointEndOf(job_->row(), experiment, fold);
  row.has_checkpoint = resumed_ || experiment.plan().samples() > 0;
  // A result does not count the samples of a warm-up.
  job_->Add({.samples = row.samples - static_cast<double>(merged.samples),
             .bytes = static_cast<int64_t>(row.bytes())});
  Failpoint("point.before_record");
  store_.RecordResult(job_->row().sequence, std::move(row),
                      [job = job_](int64_t number) { job->AddFinishedPoint(number); });
  Failpoint("point.recorded");
}

void JobJournal::Ended(const absl::Status& outcome) {
  Failpoint("job.before_end");
  RecordEnd(store_, job_, on_ended_, outcome);
  Failpoint("job.end_recorded");
}

double JobJournal::AwaitRoom() { return store_.AwaitRoom(); }

}  // namespace ballpiston::server
