#include "server/store/job_table.h"

#include <initializer_list>

#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

constexpr char kColumns[] =
    "sequence, id, principal, priority, spec, question, state, create_time, start_time, end_time,"
    " error, engine_version, cancel_request_id, points, points_done, samples, work,"
    " restarts, pinned, bytes, expired_time, length(spec) + length(grid)";

// QUEUED, RUNNING, CANCELLING.
constexpr char kActiveStates[] = "1, 2, 3";
static_assert(v1::EnsembleJob::QUEUED == 1 && v1::EnsembleJob::RUNNING == 2 &&
              v1::EnsembleJob::CANCELLING == 3);

std::optional<absl::Time> OptionalTime(const Query& query, int column) {
  if (query.IsNull(column)) return std::nullopt;
  return absl::FromUnixNanos(query.Integer(column));
}

constexpr int kGridColumn = 22;  // the last one, and there only if the grid is read

JobRecord RecordOf(const Query& query, Grid grid) {
  JobRecord record;
  record.sequence = query.Integer(0);
  record.id = query.Bytes(1);
  record.principal = query.Bytes(2);
  record.priority = static_cast<int32_t>(query.Integer(3));
  record.spec.rest = query.Bytes(4);
  record.question = query.Bytes(5);
  record.state = static_cast<JobState>(query.Integer(6));
  record.create_time = absl::FromUnixNanos(query.Integer(7));
  record.start_time = OptionalTime(query, 8);
  record.end_time = OptionalTime(query, 9);
  record.error = query.Bytes(10);
  record.engine_version = query.Bytes(11);
  record.cancel_request_id = query.Bytes(12);
  record.points = query.Integer(13);
  record.points_done = query.Integer(14);
  record.samples = query.Real(15);
  record.work = query.Real(16);
  record.restarts = query.Integer(17);
  record.pinned = query.Integer(18) != 0;
  record.bytes = query.Integer(19);
  record.expired_time = OptionalTime(query, 20);
  record.spec_bytes = query.Integer(21);
  if (grid == Grid::kIncluded) record.spec.grid = query.Bytes(kGridColumn);
  return record;
}

// The jobs that meet a condition.
template <typename... Values>
Query SelectWhere(Database& database, const char* condition, Grid grid, const Values&... values) {
  return database.Select(absl::StrCat("SELECT ", kColumns, grid == Grid::kIncluded ? ", grid" : "",
                                      " FROM jobs WHERE ", condition),
                         values...);
}

absl::StatusOr<std::optional<JobRecord>> FirstRow(Query query, Grid grid) {
  const absl::StatusOr<bool> row = query.Step();
  if (!row.ok()) return row.status();
  if (!*row) return std::nullopt;
  return RecordOf(query, grid);
}

// Updates one job. False: the job does not meet the condition.
template <typename... Values>
absl::StatusOr<bool> Update(Database& database, const std::string& sql, const Values&... values) {
  const absl::Status status = database.Run(sql, values...);
  if (!status.ok()) return status;
  return database.RowsChanged() == 1;
}

// Runs the statements for a job.
absl::Status RunFor(Database& database, int64_t sequence,
                    std::initializer_list<const char*> statements) {
  for (const char* sql : statements) {
    const absl::Status status = database.Run(sql, sequence);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

// The jobs that ended first.
absl::StatusOr<std::vector<JobSize>> Sizes(Database& database, const char* condition,
                                           absl::Time ended_before, int most) {
  std::vector<JobSize> sizes;
  const absl::Status read =
      database
          .Select(absl::StrCat("SELECT sequence, bytes FROM jobs WHERE ", condition,
                               " AND end_time < ? ORDER BY end_time LIMIT ?"),
                  absl::ToUnixNanos(ended_before), most)
          .ForEach([&](const Query& row) {
            sizes.push_back({row.Integer(0), row.Integer(1)});
            return true;
          });
  if (!read.ok()) return read;
  return sizes;
}

// Jobs whose results may expire. An index has this condition.
constexpr char kExpirable[] = "end_time IS NOT NULL AND expired_time IS NULL AND pinned = 0";

constexpr char kDropCheckpoints[] = "DELETE FROM checkpoints WHERE job = ?";
constexpr char kDropChunks[] = "DELETE FROM chunks WHERE job = ?";
constexpr char kDropResults[] = "INSERT OR IGNORE INTO dropped (job) VALUES (?)";

}  // namespace

absl::Status InsertJob(Database& database, JobRecord& record) {
  const absl::Status status = database.Run(
      "INSERT INTO jobs (id, principal, priority, spec, question, state, create_time, error,"
      " engine_version, restarts, points, points_done, samples, work, pinned, bytes, grid)"
      " VALUES (?, ?, ?, ?, ?, ?, ?, x'', ?, 0, ?, 0, 0, 0, 0, ?, ?)",
      record.id, record.principal, record.priority, Blob{record.spec.rest}, Blob{record.question},
      int64_t{record.state}, absl::ToUnixNanos(record.create_time), record.engine_version,
      record.points, record.bytes, Blob{record.spec.grid});
  record.sequence = database.LastInsertedRow();
  return status;
}

absl::StatusOr<std::optional<JobRecord>> FindJob(Database& database, const std::string& id,
                                                 Grid grid) {
  return FirstRow(SelectWhere(database, "id = ?", grid, id), grid);
}

absl::StatusOr<std::optional<JobRecord>> FindJobBySequence(Database& database, int64_t sequence,
                                                           Grid grid) {
  return FirstRow(SelectWhere(database, "sequence = ?", grid, sequence), grid);
}

absl::StatusOr<std::optional<JobRecord>> FindAnswer(Database& database,
                                                    const std::string& principal,
                                                    const std::string& question) {
  if (question.empty()) return std::nullopt;
  return FirstRow(
      SelectWhere(database,
                  "principal = ? AND question = ? AND question <> x'' AND state = ?"
                  " AND expired_time IS NULL ORDER BY sequence LIMIT 1",
                  Grid::kIncluded, principal, Blob{question}, int64_t{v1::EnsembleJob::SUCCEEDED}),
      Grid::kIncluded);
}

absl::StatusOr<Load> ActiveLoad(Database& database, const std::optional<std::string>& principal) {
  const std::string sql = absl::StrCat(
      "SELECT count(*), coalesce(sum(points), 0) FROM jobs WHERE state IN (", kActiveStates, ")");
  Query query = principal ? database.Select(absl::StrCat(sql, " AND principal = ?"), *principal)
                          : database.Select(sql);
  const absl::StatusOr<bool> row = query.Step();
  if (!row.ok()) return row.status();
  return Load{.jobs = query.Integer(0), .points = query.Integer(1)};
}

absl::StatusOr<std::map<std::string, PrincipalJobs>> CountJobsByPrincipal(Database& database) {
  std::map<std::string, PrincipalJobs> by_principal;
  const absl::Status read =
      database
          .Select(
              "SELECT principal, count(*), sum(bytes), sum(state = 1), sum(state = 2),"
              " sum(state = 3) FROM jobs GROUP BY principal")
          .ForEach([&](const Query& row) {
            by_principal[row.Bytes(0)] = {.stored = row.Integer(1),
                                          .bytes = row.Integer(2),
                                          .queued = row.Integer(3),
                                          .running = row.Integer(4),
                                          .cancelling = row.Integer(5)};
            return true;
          });
  if (!read.ok()) return read;
  return by_principal;
}

absl::Status ReadJobs(Database& database, const std::optional<std::string>& principal,
                      int64_t before, Grid grid, const std::function<bool(JobRecord job)>& on_job) {
  constexpr char kOlder[] = "sequence < ? ORDER BY sequence DESC";
  Query query = principal
                    ? SelectWhere(database, absl::StrCat("principal = ? AND ", kOlder).c_str(),
                                  grid, *principal, before)
                    : SelectWhere(database, kOlder, grid, before);
  return query.ForEach([&](const Query& row) { return on_job(RecordOf(row, grid)); });
}

absl::StatusOr<std::vector<JobRecord>> ListUnfinishedJobs(Database& database) {
  std::vector<JobRecord> records;
  const std::string active = absl::StrCat("state IN (", kActiveStates, ") ORDER BY sequence");
  const absl::Status read =
      SelectWhere(database, active.c_str(), Grid::kIncluded).ForEach([&](const Query& row) {
        records.push_back(RecordOf(row, Grid::kIncluded));
        return true;
      });
  if (!read.ok()) return read;
  return records;
}

absl::StatusOr<bool> BeginJob(Database& database, int64_t sequence, absl::Time now) {
  return Update(database,
                "UPDATE jobs SET state = ?, start_time = ? WHERE sequence = ? AND state = ?",
                int64_t{v1::EnsembleJob::RUNNING}, absl::ToUnixNanos(now), sequence,
                int64_t{v1::EnsembleJob::QUEUED});
}

absl::StatusOr<bool> BeginCancellation(Database& database, int64_t sequence,
                                       const std::string& request_id) {
  return Update(database,
                "UPDATE jobs SET state = ?, cancel_request_id = nullif(?, '')"
                " WHERE sequence = ? AND state IN (?, ?)",
                int64_t{v1::EnsembleJob::CANCELLING}, request_id, sequence,
                int64_t{v1::EnsembleJob::QUEUED}, int64_t{v1::EnsembleJob::RUNNING});
}

absl::StatusOr<std::optional<JobRecord>> EndJob(Database& database, int64_t sequence,
                                                const JobEnd& end) {
  const absl::StatusOr<bool> has_ended = Update(
      database,
      absl::StrCat("UPDATE jobs SET state = iif(state = ?1, ?2, ?3), end_time = ?4,"
                   " error = iif(state = ?1, x'', ?5), points_done = ?6, samples = ?7, work = ?8,"
                   " bytes = ?9 WHERE sequence = ?10 AND state IN (",
                   kActiveStates, ")"),
      int64_t{v1::EnsembleJob::CANCELLING}, int64_t{v1::EnsembleJob::CANCELLED}, int64_t{end.state},
      absl::ToUnixNanos(end.time), Blob{end.error}, end.points_done, end.samples, end.work,
      end.bytes, sequence);
  if (!has_ended.ok()) return has_ended.status();
  if (!*has_ended) return std::nullopt;
  const absl::Status dropped = RunFor(database, sequence, {kDropCheckpoints, kDropChunks});
  if (!dropped.ok()) return dropped;
  return FindJobBySequence(database, sequence, Grid::kIncluded);
}

absl::Status RestartJob(Database& database, int64_t sequence, const std::string& engine_version,
                        const std::string& question) {
  const absl::Status dropped =
      RunFor(database, sequence,
             {kDropCheckpoints, kDropChunks, "DELETE FROM results WHERE job = ?",
              "DELETE FROM details WHERE job = ?"});
  if (!dropped.ok()) return dropped;
  return database.Run(
      "UPDATE jobs SET engine_version = ?, question = ?, restarts = restarts + 1"
      " WHERE sequence = ?",
      engine_version, Blob{question}, sequence);
}

absl::Status UpdateJob(Database& database, const JobRecord& record) {
  return database.Run("UPDATE jobs SET pinned = ?, priority = ? WHERE sequence = ?", record.pinned,
                      record.priority, record.sequence);
}

absl::StatusOr<std::vector<JobSize>> ListExpirable(Database& database, absl::Time ended_before,
                                                   int most) {
  return Sizes(database, kExpirable, ended_before, most);
}

absl::StatusOr<std::vector<JobSize>> ListExpired(Database& database, int most) {
  return Sizes(database, "expired_time IS NOT NULL", absl::InfiniteFuture(), most);
}

absl::StatusOr<int64_t> CountExpirable(Database& database, absl::Time ended_before) {
  return database.Integer(
      absl::StrCat("SELECT count(*) FROM jobs WHERE ", kExpirable, " AND end_time < ?"),
      absl::ToUnixNanos(ended_before));
}

absl::Status ExpireJob(Database& database, int64_t sequence, absl::Time now) {
  const absl::StatusOr<bool> has_expired =
      Update(database,
             "UPDATE jobs SET expired_time = ?, bytes = length(spec) + length(grid)"
             " WHERE sequence = ? AND pinned = 0",
             absl::ToUnixNanos(now), sequence);
  if (!has_expired.ok() || !*has_expired) return has_expired.status();
  return database.Run(kDropResults, sequence);
}

absl::Status DeleteJob(Database& database, int64_t sequence) {
  return RunFor(database, sequence,
                {kDropCheckpoints, kDropChunks, kDropResults, "DELETE FROM requests WHERE job = ?",
                 "DELETE FROM jobs WHERE sequence = ?"});
}

}  // namespace ballpiston::server
