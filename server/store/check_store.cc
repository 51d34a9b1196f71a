#include "server/store/check_store.h"

#include <sys/stat.h>

#include <optional>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "google/rpc/status.pb.h"
#include "server/convert/fold_record.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "server/store/schema.h"
#include "server/store/sqlite.h"
#include "server/store/unused_log.h"

namespace ballpiston::server {
namespace {

using v1::EnsembleJob;

bool Ended(int64_t state) { return state >= EnsembleJob::SUCCEEDED; }

// The size of the log, whose pages are not written back yet.
int64_t LogBytes(const std::string& store) {
  struct stat found {};
  return stat((store + "-wal").c_str(), &found) == 0 ? int64_t{found.st_size} : 0;
}

// Runs the checks one after the other, and collects what they find.
class StoreCheck {
 public:
  explicit StoreCheck(Database& database) : database_(database) {}

  absl::StatusOr<StoreSummary> Run() {
    const absl::Status begun = database_.Execute("BEGIN");
    if (!begun.ok()) return begun;
    for (const auto part :
         {&StoreCheck::CheckPages, &StoreCheck::Count, &StoreCheck::CheckJobs,
          &StoreCheck::CheckRows, &StoreCheck::CheckResults, &StoreCheck::CheckCheckpoints}) {
      const absl::Status status = (this->*part)();
      if (absl::IsUnavailable(status)) return status;
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

  // Calls `take` for each row.
  template <typename Take>
  absl::Status ForEach(const std::string& sql, Take take) {
    return database_.Select(sql).ForEach([&](const Query& row) {
      take(row);
      return true;
    });
  }

  absl::Status CheckPages() {
    return ForEach(absl::StrCat("PRAGMA integrity_check(", kMaxProblems, ")"),
                   [this](const Query& row) {
                     if (row.Bytes(0) != "ok") Found(row.Bytes(0));
                   });
  }

  absl::Status Count() {
    for (const auto& [sql, number] :
         {std::pair{"PRAGMA user_version", &summary_.version},
          std::pair{"SELECT count(*) FROM results", &summary_.results},
          std::pair{"SELECT count(*) FROM checkpoints", &summary_.checkpoints}}) {
      const auto value = database_.Integer(sql);
      if (!value.ok()) return value.status();
      *number = *value;
    }
    const auto bytes = database_.FileBytes();
    if (bytes.ok()) summary_.bytes = *bytes;
    return ForEach("SELECT state, count(*) FROM jobs GROUP BY state", [this](const Query& row) {
      const auto state = static_cast<EnsembleJob::State>(row.Integer(0));
      const bool known = EnsembleJob::State_IsValid(state);
      summary_.jobs[known ? EnsembleJob::State_Name(state) : absl::StrCat("state ", state)] =
          row.Integer(1);
    });
  }

  absl::Status CheckJobs() {
    return ForEach(
        "SELECT id, state, spec, error, end_time IS NULL, points, points_done,"
        " (SELECT count(*) FROM results WHERE job = sequence), expired_time IS NOT NULL, grid FROM "
        "jobs",
        [this](const Query& row) { CheckJob(row); });
  }

  void CheckJob(const Query& row) {
    const std::string job = absl::StrCat("job ", row.Bytes(0));
    const int64_t state = row.Integer(1);
    if (state < EnsembleJob::QUEUED || state > EnsembleJob::CANCELLED) {
      return Found(absl::StrCat(job, " has an unknown state: ", state));
    }
    const absl::StatusOr<v1::EnsembleSpec> spec = SpecFromBytes({row.Bytes(2), row.Bytes(9)});
    if (!spec.ok()) Found(absl::StrCat(job, ": ", spec.status().message()));
    if (!google::rpc::Status().ParseFromString(row.Bytes(3))) {
      Found(absl::StrCat(job, ": its error cannot be read"));
    }
    const bool has_error = !row.Bytes(3).empty();
    if (has_error != (state == EnsembleJob::FAILED)) {
      Found(
          absl::StrCat(job, has_error ? " did not fail, but has" : " failed without", " an error"));
    }
    if ((row.Integer(4) == 0) != Ended(state)) {
      Found(absl::StrCat(
          job, Ended(state) ? " ended but has no end time" : " is active but has an end time"));
    }
    const bool has_expired = row.Integer(8) != 0;
    if (!has_expired) CheckPoints(job, state, row.Integer(5), row.Integer(6), row.Integer(7));
  }

  void CheckPoints(const std::string& job, int64_t state, int64_t points, int64_t done,
                   int64_t results) {
    if (points < 1) Found(absl::StrCat(job, " has ", points, " points"));
    if (results > points) Found(absl::StrCat(job, ": ", results, " results of ", points));
    if (Ended(state) && done != results) {
      Found(absl::StrCat(job, " finished ", done, " points and has ", results, " results"));
    }
    if (state == EnsembleJob::SUCCEEDED && results != points) {
      Found(absl::StrCat(job, " succeeded with ", results, " results of ", points));
    }
  }

  // Finds rows whose job or point does not exist.
  absl::Status CheckRows() {
    const auto report = [this](const char* what) {
      return [this, what](const Query& row) {
        Found(absl::StrCat(what, ": job ", row.Integer(0), ", point ", row.Integer(1)));
      };
    };
    const absl::Status results = ForEach(
        "SELECT job, point FROM results LEFT JOIN jobs ON sequence = job"
        " WHERE ((sequence IS NULL OR expired_time IS NOT NULL)"
        "  AND job NOT IN (SELECT job FROM dropped))"
        " OR point < 0 OR point >= points",
        report("a result without a point"));
    if (!results.ok()) return results;
    const absl::Status details = ForEach(
        "SELECT details.job, details.point FROM details LEFT JOIN results"
        " ON results.job = details.job AND results.point = details.point"
        " WHERE results.job IS NULL AND details.job NOT IN (SELECT job FROM dropped)",
        report("details without a result"));
    if (!details.ok()) return details;
    const absl::Status checkpoints =
        ForEach(absl::StrCat("SELECT job, point FROM checkpoints LEFT JOIN jobs ON sequence = job"
                             " WHERE sequence IS NULL OR point < 0 OR point >= points OR state >= ",
                             int{EnsembleJob::SUCCEEDED}),
                report("a checkpoint without a point of an active job"));
    if (!checkpoints.ok()) return checkpoints;
    const absl::Status requests = ForEach(
        "SELECT job, request_id FROM requests LEFT JOIN jobs ON sequence = job"
        " WHERE sequence IS NULL",
        [this](const Query& row) {
          Found(absl::StrCat("request ", row.Bytes(1), " has no job: ", row.Integer(0)));
        });
    if (!requests.ok()) return requests;
    return ForEach(
        "SELECT checkpoints.job, checkpoints.point FROM checkpoints JOIN results"
        " ON results.job = checkpoints.job AND results.point = checkpoints.point",
        report("a checkpoint of a finished point"));
  }

  absl::Status CheckResults() {
    return ForEach(
        "SELECT job, point, result, record FROM results LEFT JOIN details USING (job, point)",
        [this](const Query& row) {
          const absl::StatusOr<v1::PointResult> result = ResultFromBytes(row.Bytes(2));
          absl::Status status = result.status();
          status.Update(DetailsFromBytes(row.Bytes(3)).status());
          if (status.ok() && result->index() != row.Integer(1)) {
            status = absl::DataLossError(absl::StrCat("is of point ", result->index()));
          }
          if (status.ok()) return;
          Found(absl::StrCat("the result of job ", row.Integer(0), ", point ", row.Integer(1), ": ",
                             status.message()));
        });
  }

  absl::Status CheckCheckpoints() {
    return ForEach("SELECT job, point, record FROM checkpoints", [this](const Query& row) {
      const auto state = FoldStateFromBytes(row.Bytes(2));
      if (state.ok()) return;
      Found(absl::StrCat("the checkpoint of job ", row.Integer(0), ", point ", row.Integer(1), ": ",
                         state.status().message()));
    });
  }

  Database& database_;
  StoreSummary summary_;
};

}  // namespace

absl::StatusOr<StoreSummary> CheckStore(const std::string& path, const std::string& vfs) {
  std::optional<UnusedLog> log;
  if (vfs.empty()) log.emplace(path);
  const auto database = OpenStoreToRead(path, vfs);
  if (!database.ok()) return database.status();
  absl::StatusOr<StoreSummary> summary = StoreCheck(**database).Run();
  if (summary.ok() && log) summary->bytes += LogBytes(path);
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
