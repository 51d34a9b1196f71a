#include "server/store/check_store.h"

#include <limits>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/convert/fold_record.h"
#include "server/convert/point_result.h"
#include "server/store/data_directory.h"
#include "server/store/job_table.h"
#include "server/store/schema.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {
namespace {

using v1::EnsembleJob;

static_assert(EnsembleJob::QUEUED == 1 && EnsembleJob::SUCCEEDED == 4 &&
              EnsembleJob::CANCELLED == 6);

// Each selects a sentence for each row that contradicts others.
constexpr const char* kContradictions[] = {
    "SELECT 'job ' || id || ' has an unknown state: ' || state FROM jobs"
    " WHERE state NOT BETWEEN 1 AND 6",
    "SELECT 'job ' || id || iif(state >= 4, ' ended but has no', ' is active but has an')"
    " || ' end time' FROM jobs WHERE (end_time IS NOT NULL) <> (state >= 4)",
    "SELECT 'job ' || id || ' has ' || points || ' points' FROM jobs WHERE points < 1",
    "SELECT 'job ' || id || ': ' || count(*) || ' results of ' || points FROM jobs"
    " JOIN results ON job = sequence WHERE expired = 0 GROUP BY job"
    " HAVING count(*) > points",
    "SELECT 'job ' || id || ' finished ' || points_done || ' points and has ' || count(job)"
    " || ' results' FROM jobs LEFT JOIN results ON job = sequence"
    " WHERE expired = 0 AND state >= 4 GROUP BY sequence HAVING count(job) <> points_done",
    "SELECT 'job ' || id || ' succeeded with ' || points_done || ' results of ' || points"
    " FROM jobs WHERE expired = 0 AND state = 4 AND points_done <> points",
    "SELECT 'a result without a point: job ' || coalesce(id, job) || ', point ' || point"
    " FROM results LEFT JOIN jobs ON sequence = job"
    " WHERE ((sequence IS NULL OR expired = 1)"
    " AND job NOT IN (SELECT job FROM dropped)) OR point < 0 OR point >= points",
    "SELECT 'a checkpoint without a point of an active job: job ' || coalesce(id, job)"
    " || ', point ' || point FROM checkpoints LEFT JOIN jobs ON sequence = job"
    " WHERE sequence IS NULL OR point < 0 OR point >= points OR state >= 4",
    "SELECT 'a checkpoint of a finished point: job ' || coalesce(id, job) || ', point ' || point"
    " FROM checkpoints JOIN results USING (job, point) LEFT JOIN jobs ON sequence = job",
};

// Runs the checks one after the other, and collects what they find.
class StoreCheck {
 public:
  explicit StoreCheck(Database& database) : database_(database) {}

  absl::StatusOr<StoreSummary> Run() {
    database_.Execute("BEGIN");
    for (const auto part :
         {&StoreCheck::CheckPages, &StoreCheck::Count, &StoreCheck::FindContradictions,
          &StoreCheck::CheckJobs, &StoreCheck::CheckResults, &StoreCheck::CheckCheckpoints}) {
      (this->*part)();
      const absl::Status status = database_.TakeStatus();
      if (IsOfTheDisk(status)) return status;
      // The damage prevents reading this part.
      if (!status.ok()) Found(std::string(status.message()));
    }
    return std::move(summary_);
  }

 private:
  void Found(const std::string& sentence) {
    ++summary_.problem_count;
    if (summary_.problems.size() < kMaxProblems) summary_.problems.push_back(sentence);
  }

  // No effect if `status` is OK.
  void FoundIn(const std::string& what, const absl::Status& status) {
    if (!status.ok()) Found(absl::StrCat(what, ": ", status.message()));
  }

  void CheckPages() {
    for (const std::string& found :
         database_.All<std::string>(absl::StrCat("PRAGMA integrity_check(", kMaxProblems, ")"))) {
      if (found != "ok") Found(found);
    }
  }

  void Count() {
    summary_.version = database_.Integer("PRAGMA user_version");
    summary_.results = database_.Integer("SELECT count(*) FROM results");
    summary_.checkpoints = database_.Integer("SELECT count(*) FROM checkpoints");
    Query row = database_.Select("SELECT state, count(*) FROM jobs GROUP BY state");
    while (row.Next()) {
      const auto state = row.Get<EnsembleJob::State>(0);
      const std::string& name = EnsembleJob::State_Name(state);
      summary_.jobs[name.empty() ? absl::StrCat("state ", state) : name] = row.Get<int64_t>(1);
    }
  }

  void FindContradictions() {
    for (const char* sql : kContradictions) {
      for (const std::string& sentence : database_.All<std::string>(sql)) Found(sentence);
    }
  }

  void CheckJobs() {
    constexpr int64_t kNewest = std::numeric_limits<int64_t>::max();
    ReadJobs(database_, std::nullopt, kNewest, Grid::kIncluded, [&](const JobRecord& record) {
      const bool has_failed = record.job.state() == EnsembleJob::FAILED;
      if (!record.job.has_spec()) Found(absl::StrCat("job ", record.id, " cannot be read"));
      if (record.job.has_error() != has_failed) {
        Found(absl::StrCat("job ", record.id,
                           has_failed ? " failed without" : " did not fail, but has", " an error"));
      }
      return true;
    });
  }

  void CheckResults() {
    Query row = database_.Select(
        "SELECT coalesce(id, job), point, result, details, continuation FROM results"
        " LEFT JOIN jobs ON sequence = job");
    while (row.Next()) {
      const auto result = ResultFromBytes(row.Get<std::string>(2));
      absl::Status status = result.status();
      status.Update(DetailsFromBytes(row.Get<std::string>(3)).status());
      const auto end = row.Get<std::string>(4);
      if (!end.empty()) status.Update(EndFromBytes(end).status());
      if (status.ok() && result->index() != row.Get<int64_t>(1)) {
        status = absl::DataLossError(absl::StrCat("is of point ", result->index()));
      }
      FoundIn(absl::StrCat("the result of ", PointOf(row)), status);
    }
  }

  void CheckCheckpoints() {
    Query row = database_.Select(
        "SELECT coalesce(id, job), point, record FROM checkpoints"
        " LEFT JOIN jobs ON sequence = job");
    while (row.Next()) {
      FoundIn(absl::StrCat("the checkpoint of ", PointOf(row)),
              FoldStateFromBytes(row.Get<std::string>(2)).status());
    }
  }

  // The first columns are the job's id, or its number if there is no such job, and the point.
  static std::string PointOf(const Query& row) {
    return absl::StrCat("job ", row.Get<std::string>(0), ", point ", row.Get<int64_t>(1));
  }

  Database& database_;
  StoreSummary summary_;
};

}  // namespace

absl::StatusOr<StoreSummary> CheckStore(const std::string& path) {
  const auto database = OpenStoreToRead(path);
  if (!database.ok()) return database.status();
  absl::StatusOr<StoreSummary> summary = StoreCheck(**database).Run();
  if (summary.ok()) summary->bytes = StoreBytes(path);
  return summary;
}

std::string SummaryText(const StoreSummary& summary) {
  std::string text =
      absl::StrCat("version ", summary.version, ", ", summary.bytes, " bytes\n", summary.results,
                   " results, ", summary.checkpoints, " checkpoints of unfinished points\njobs:");
  for (const auto& [state, count] : summary.jobs) absl::StrAppend(&text, " ", count, " ", state);
  if (summary.jobs.empty()) absl::StrAppend(&text, " none");
  for (const std::string& problem : summary.problems) absl::StrAppend(&text, "\n", problem);
  const auto told = static_cast<int64_t>(summary.problems.size());
  if (summary.problem_count > told) {
    absl::StrAppend(&text, "\nand ", summary.problem_count - told, " more");
  }
  return absl::StrCat(text, "\n", summary.sound() ? "the store is sound" : "the store is damaged");
}

}  // namespace ballpiston::server
