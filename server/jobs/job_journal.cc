#include "server/jobs/job_journal.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/errors.h"
#include "server/convert/fold_record.h"
#include "server/convert/point_result.h"
#include "server/host.h"
#include "server/jobs/job_log.h"
#include "server/observability/failpoint.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"

namespace ballpiston::server {
namespace {

// Bytes of memory; histograms take most of it.
size_t BytesHeld(const BlockResult& result) {
  size_t bytes = sizeof(BlockResult);
  for (const Histogram& histogram : result.histograms) {
    bytes += histogram.counts.size() * sizeof(histogram.counts[0]);
  }
  return bytes;
}

JobEnd EndOf(const Job& job, const absl::Status& outcome) {
  const LiveNumbers numbers = job.Numbers();
  JobEnd end;
  end.time = WallNow();
  end.points_done = numbers.points_done;
  end.samples = numbers.samples;
  end.work = numbers.work;
  end.bytes = numbers.bytes;
  if (outcome.ok()) {
    end.state = v1::EnsembleJob::SUCCEEDED;
  } else if (absl::IsCancelled(outcome)) {
    end.state = v1::EnsembleJob::CANCELLED;
  } else {
    end.state = v1::EnsembleJob::FAILED;
    end.error = RpcStatus(WithDefaultReason(outcome, "COMPUTATION_FAILED")).SerializeAsString();
  }
  return end;
}

// Sets `ended` to the new row, if the job was active.
absl::Status WriteEnd(Database& database, const Job& job, const JobEnd& end,
                      std::optional<JobRecord>& ended) {
  absl::StatusOr<std::optional<JobRecord>> row = EndJob(database, job.sequence(), end);
  if (row.ok()) ended = *std::move(row);
  return row.status();
}

void TellEnd(Job& job, const std::optional<JobRecord>& ended, const JobJournal::OnEnded& on_ended) {
  if (!ended) return;
  Failpoint("job.ended");
  LogEnd(*ended);
  if (on_ended) on_ended(*ended);
  job.NoteStateChange();
}

// The job fails, because no client may wait for ever for an end that the store rejects.
void RecordRejectedEnd(Store& store, const std::shared_ptr<Job>& job, const absl::Status& why,
                       const JobJournal::OnEnded& on_ended) {
  const absl::Status failure =
      absl::IsDataLoss(why)
          ? StoreFailure(why)
          : absl::InternalError(absl::StrCat("the store rejected the job's end: ", why.message()));
  const auto ended = std::make_shared<std::optional<JobRecord>>();
  store.RecordSoon([job, ended, end = EndOf(*job, failure)](
                       Database& database) { return WriteEnd(database, *job, end, *ended); },
                   [job, ended, on_ended](const absl::Status& done) {
                     if (done.ok()) TellEnd(*job, *ended, on_ended);
                   });
}

// The job fails if the store rejected one of its results, because clients could not read it.
absl::Status CountStoredPoints(Database& database, const Job& job, JobEnd& end) {
  const absl::StatusOr<int64_t> stored = CountResults(database, job.sequence());
  if (!stored.ok()) return stored.status();
  end.points_done = *stored;
  if (end.state != v1::EnsembleJob::SUCCEEDED || *stored == job.points()) return absl::OkStatus();
  const absl::Status lost = absl::DataLossError(
      absl::StrCat("of ", job.points(), " computed points the store keeps ", *stored));
  end.state = v1::EnsembleJob::FAILED;
  end.error = RpcStatus(StoreFailure(lost)).SerializeAsString();
  return absl::OkStatus();
}

}  // namespace

JobJournal::JobJournal(std::shared_ptr<Job> job, Store& store, bool resumed, OnEnded on_ended)
    : job_(std::move(job)), store_(store), resumed_(resumed), on_ended_(std::move(on_ended)) {}

void JobJournal::Began() {
  const auto begun = std::make_shared<bool>(false);
  const auto begin = [sequence = job_->sequence(), now = WallNow(), begun](Database& database) {
    const absl::StatusOr<bool> changed = BeginJob(database, sequence, now);
    *begun = changed.value_or(false);
    return changed.status();
  };
  store_.Record(begin, [job = job_, begun](const absl::Status& done) {
    if (!done.ok() || !*begun) return;
    LogState(*job, v1::EnsembleJob::RUNNING);
    job->NoteStateChange();
  });
}

absl::StatusOr<StoredPoint> JobJournal::ReadPoint(size_t point) {
  std::optional<std::string> checkpoint;
  std::vector<std::string> chunks;
  const absl::Status read = store_.Read([&](Database& database) {
    const auto index = static_cast<int64_t>(point);
    auto found = ReadCheckpoint(database, job_->sequence(), index);
    if (!found.ok()) return found.status();
    checkpoint = *std::move(found);
    auto early = ReadChunks(database, job_->sequence(), index);
    if (early.ok()) chunks = *std::move(early);
    return early.status();
  });
  if (!read.ok()) return read;
  StoredPoint stored;
  if (checkpoint) {
    absl::StatusOr<FoldState> state = FoldStateFromBytes(*checkpoint);
    if (!state.ok()) return state.status();
    stored.state = *std::move(state);
  }
  for (const std::string& bytes : chunks) {
    absl::StatusOr<ChunkResult> chunk = ChunkFromBytes(bytes);
    if (!chunk.ok()) return chunk.status();
    stored.chunks.push_back(*std::move(chunk));
  }
  return stored;
}

uint64_t JobJournal::Merged(const MergedSamples& merged) {
  const uint64_t change =
      job_->AddSamples(static_cast<double>(merged.samples), merged.share_of_point);
  Failpoint(merged.restored ? "resume.point" : "block.merged");
  return change;
}

void JobJournal::Checkpoint(size_t point, const FoldState& state) {
  // Shared, because the store's closures must be copyable. Serialized only if it is written.
  auto copy = std::make_shared<const FoldState>(state);
  const size_t bytes = BytesHeld(copy->complete) + BytesHeld(copy->partial) +
                       copy->chunk_digests.size() * sizeof(uint64_t);
  store_.RecordCheckpoint(
      job_->sequence(), static_cast<int64_t>(point), state.chunk,
      [copy = std::move(copy)] { return FoldRecordBytes(*copy); }, bytes);
}

void JobJournal::ChunkIsEarly(size_t point, const ChunkResult& chunk) {
  store_.RecordChunk(job_->sequence(), static_cast<int64_t>(point), chunk.chunk,
                     ChunkRecordBytes(chunk));
}

void JobJournal::Worked(double seconds) { job_->AddWork(seconds); }

void JobJournal::PointFinished(size_t point, const PointExperiment& experiment,
                               const BlockResult& merged,
                               const std::vector<uint64_t>& chunk_digests) {
  if (experiment.plan().samples() == 0) job_->AddSamples(0, 1);  // computed without one
  const PointSummary summary = experiment.Summarize(merged);
  PointRow row = {static_cast<int64_t>(point), static_cast<double>(summary.samples),
                  DeterministicBytes(ResultOf(point, experiment, summary)),
                  DetailsBytes(DetailsOf(summary, chunk_digests))};
  row.has_checkpoint = resumed_ || experiment.plan().samples() > 0;
  auto told = std::make_shared<const std::string>(row.result);
  job_->AddBytes(static_cast<int64_t>(row.result.size() + row.details.size()));
  Failpoint("point.before_record");
  store_.RecordResult(job_->sequence(), std::move(row),
                      [job = job_, told = std::move(told)](int64_t number) {
                        job->AddFinishedPoint({number, told});
                      });
  Failpoint("point.recorded");
}

void JobJournal::Ended(const absl::Status& outcome) {
  const JobEnd computed = EndOf(*job_, outcome);
  Failpoint("job.before_end");
  const auto ended = std::make_shared<std::optional<JobRecord>>();
  const auto change = [job = job_, computed, ended](Database& database) {
    JobEnd end = computed;
    const absl::Status counted = CountStoredPoints(database, *job, end);
    return counted.ok() ? WriteEnd(database, *job, end, *ended) : counted;
  };
  store_.RecordSoon(
      change, [job = job_, &store = store_, ended, on_ended = on_ended_](const absl::Status& done) {
        if (done.ok()) return TellEnd(*job, *ended, on_ended);
        if (!IsOfTheDisk(done)) RecordRejectedEnd(store, job, done, on_ended);  // else it is closed
      });
  Failpoint("job.end_recorded");
}

void JobJournal::AwaitRoom() { store_.AwaitRoom(); }

}  // namespace ballpiston::server
