// The methods of the book that only read.
#include <limits>
#include <utility>

#include "server/book/job_book.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "server/store/job_name.h"
#include "server/store/point_tables.h"

namespace ballpiston::server {
namespace {

// Finished points are read until they have this many bytes.
constexpr size_t kMaxBytesOfPoints = size_t{512} << 10;

// Null: the specification cannot be read, or has an experiment of a test.
const ExperimentKind* ExperimentOf(const JobRecord& record) {
  return FindExperiment(static_cast<uint64_t>(record.job.spec().experiment()));
}

// With its name, which the store does not keep.
v1::PointResult Named(v1::PointResult result, const JobRecord& job) {
  result.set_name(ResultName(job.id, result.index()));
  return result;
}

ResultsPage ReadResultsPage(Database& database, const JobRecord& record,
                            const ResultsQuery& query) {
  const ExperimentKind* const experiment = ExperimentOf(record);
  if (experiment == nullptr) database.Fail(absl::DataLossError("the experiment is unknown"));
  ResultsPage page;
  size_t bytes = 0;
  const auto take = [&](const PointRow& row) {
    v1::PointResult result = database.ValueOf(ResultFromBytes(row.result));
    const v1::PointResult details = database.ValueOf(DetailsFromBytes(row.details));
    if (!database.status().ok()) return false;
    result = WithDetails(std::move(result), details, *experiment);
    bytes += result.ByteSizeLong();
    const bool full = page.points.size() == static_cast<size_t>(query.max_points);
    const bool ends = full || (!page.points.empty() && bytes > query.max_bytes);
    if (ends) page.next_point = row.point;
    if (!ends) page.points.push_back(Named(std::move(result), record));
    return !ends;
  };
  const Details details = query.histograms ? Details::kIncluded : Details::kLeftOut;
  ReadResults(database, record.sequence, query.first_point, details, take);
  return page;
}

}  // namespace

absl::StatusOr<JobRecord> JobBook::ReadRecord(const Principal& caller, const std::string& id,
                                              Grid grid) {
  auto record = store_.Read([&](Database& database) { return JobOf(database, caller, id, grid); });
  if (!record.ok()) return StoreFailure(record.status());
  return record;
}

absl::StatusOr<FoundJob> JobBook::Find(const Principal& caller, const std::string& id, Grid grid) {
  absl::StatusOr<JobRecord> record = ReadRecord(caller, id, grid);
  if (!record.ok()) return record.status();
  return WithNumbers(caller, *std::move(record), grid);
}

absl::StatusOr<FoundJob> JobBook::WithNumbers(const Principal& caller, JobRecord record,
                                              Grid grid) {
  if (HasEnded(record.job.state())) return FoundJob{std::move(record)};
  if (auto job = active_.Find(record.id)) return FoundJob{std::move(record), std::move(job)};
  absl::StatusOr<JobRecord> ended = ReadRecord(caller, record.id, grid);
  if (!ended.ok()) return ended.status();
  return FoundJob{*std::move(ended)};
}

absl::StatusOr<v1::EnsembleJob> JobBook::Get(const Principal& caller, const std::string& id,
                                             Grid grid) {
  const absl::StatusOr<FoundJob> found = Find(caller, id, grid);
  if (!found.ok()) return found.status();
  return Message(found->record, found->active.get());
}

v1::EnsembleJob JobBook::Message(const JobRecord& record, const Job* active) const {
  v1::EnsembleJob job = record.job;
  if (active != nullptr) SetNumbers(active->Numbers(), job);
  SetExpireTime(limits_.retain_days, job);
  return job;
}

absl::StatusOr<JobsPage> JobBook::List(const Principal& caller, const JobsQuery& query) {
  const bool everybodys = caller.role == Role::kAdmin;
  const auto read = store_.Read([&](Database& database) {
    return ReadPage(database, everybodys ? std::nullopt : std::optional(caller.name), query);
  });
  if (!read.ok()) return StoreFailure(read.status());
  JobsPage page{.next_before = read->next_before};
  for (const JobRecord& record : read->jobs) {
    const absl::StatusOr<FoundJob> job = WithNumbers(caller, record, query.grid);
    if (absl::IsNotFound(job.status())) continue;  // it was deleted meanwhile
    if (!job.ok()) return job.status();
    if (!query.filter.MatchesState(job->record.job.state())) continue;
    page.jobs.push_back(Message(job->record, job->active.get()));
  }
  return page;
}

absl::StatusOr<ResultsPage> JobBook::Results(const Principal& caller, const std::string& id,
                                             const ResultsQuery& query) {
  auto page = store_.Read([&](Database& database) {
    const JobRecord record = JobOf(database, caller, id, Grid::kLeftOut);
    if (record.job.results_expired()) database.Fail(ResultsExpired(JobName(id)));
    return ReadResultsPage(database, record, query);
  });
  if (!page.ok()) return StoreFailure(page.status());
  return page;
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
  const JobRecord& record = found->record;
  const ExperimentKind* const experiment = ExperimentOf(record);
  if (found->active == nullptr || experiment == nullptr) return std::nullopt;
  const auto live = scheduler_.Unfinished(record.sequence, static_cast<size_t>(point));
  if (!live) return std::nullopt;
  const CrashRecord::Entry examining(*crashes_, RunOf(record));
  const PointSummary summary = live->experiment->Summarize(live->merged);
  return Named(WithDetails(ResultOf(live->index, *live->experiment, summary), DetailsOf(summary),
                           *experiment),
               record);
}

// ---- for watches ----

std::shared_ptr<const JobSnapshot> JobBook::Snapshot(Job& job, std::chrono::milliseconds max_age,
                                                     size_t limit) const {
  return job.Snapshot(max_age, [&] {
    const CrashRecord::Entry examining(*crashes_, RunOf(job.row()));
    JobSnapshot snapshot;
    snapshot.change = job.last_change();  // read before the points, which may be newer
    snapshot.finished = job.last_finished();
    for (const LivePoint& point : scheduler_.NewestPoints(job.row().sequence, limit)) {
      const PointSummary summary = point.experiment->Summarize(point.merged);
      snapshot.points.push_back(
          {point.version, Named(ResultOf(point.index, *point.experiment, summary), job.row())});
    }
    return snapshot;
  });
}

absl::StatusOr<std::vector<FinishedPoint>> JobBook::FinishedAfter(const JobRecord& record,
                                                                  const Job* active, int64_t after,
                                                                  size_t limit) {
  // A point that the job does not have yet would give a token that the job does not know.
  const int64_t last = active ? active->last_finished() : std::numeric_limits<int64_t>::max();
  std::vector<FinishedPoint> points;
  if (last <= after || record.job.results_expired()) return points;
  // They are parsed after the read, because all watches share a few connections that read.
  std::vector<std::pair<int64_t, std::string>> stored;
  size_t bytes = 0;
  const absl::Status read = store_.Read([&](Database& database) {
    const auto take = [&](int64_t number, std::string result) {
      if (number > last) return false;
      bytes += result.size();
      stored.emplace_back(number, std::move(result));
      return stored.size() < limit && bytes < kMaxBytesOfPoints;
    };
    ReadResultsStoredAfter(database, record.sequence, after, take);
  });
  if (!read.ok()) return StoreFailure(read);
  for (const auto& [number, text] : stored) {
    absl::StatusOr<v1::PointResult> result = ResultFromBytes(text);
    if (!result.ok()) return StoreFailure(result.status());
    points.push_back({number, Named(*std::move(result), record)});
  }
  return points;
}

}  // namespace ballpiston::server
