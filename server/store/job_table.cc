#include "server/store/job_table.h"

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

void BindTextOrNull(Query& query, const std::string& text) {
  if (text.empty()) {
    query.BindNull();
  } else {
    query.BindText(text);
  }
}

// Selects the jobs that meet the caller's condition.
std::string SelectWhere(const char* condition, Grid grid) {
  return absl::StrCat("SELECT ", kColumns, grid == Grid::kIncluded ? ", grid" : "",
                      " FROM jobs WHERE ", condition);
}

absl::StatusOr<std::optional<JobRecord>> FirstRow(Query& query, Grid grid) {
  const absl::StatusOr<bool> row = query.Step();
  if (!row.ok()) return row.status();
  if (!*row) return std::nullopt;
  return RecordOf(query, grid);
}

absl::StatusOr<std::vector<JobRecord>> AllRows(Query& query, Grid grid) {
  std::vector<JobRecord> records;
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return records;
    records.push_back(RecordOf(query, grid));
  }
}

// Runs an update of one job. False: the job did not meet its condition.
absl::StatusOr<bool> HasChanged(Database& database, Query& update) {
  const absl::Status status = update.Run();
  if (!status.ok()) return status;
  return database.RowsChanged() == 1;
}

absl::Status RunFor(Database& database, int64_t sequence, const char* sql) {
  return database.Prepare(sql).Bind(sequence).Run();
}

// The jobs that ended first.
absl::StatusOr<std::vector<JobSize>> Sizes(Database& database, const char* condition,
                                           absl::Time ended_before, int most) {
  Query query = database.Prepare(absl::StrCat("SELECT sequence, bytes FROM jobs WHERE ", condition,
                                              " AND end_time < ? ORDER BY end_time LIMIT ?"));
  query.Bind(absl::ToUnixNanos(ended_before)).Bind(int64_t{most});
  std::vector<JobSize> sizes;
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return sizes;
    sizes.push_back({query.Integer(0), query.Integer(1)});
  }
}

// Jobs whose results may expire. An index has this condition.
constexpr char kExpirable[] = "end_time IS NOT NULL AND expired_time IS NULL AND pinned = 0";

// The rows of a job's unfinished points.
constexpr const char* kDropUnfinished[] = {"DELETE FROM checkpoints WHERE job = ?",
                                           "DELETE FROM chunks WHERE job = ?"};
constexpr char kDropResults[] = "INSERT OR IGNORE INTO dropped (job) VALUES (?)";

}  // namespace

absl::Status InsertJob(Database& database, JobRecord& record) {
  Query query = database.Prepare(
      "INSERT INTO jobs (id, principal, priority, spec, question, state, create_time, error,"
      " engine_version, restarts, points, points_done, samples, work, pinned, bytes, grid)"
      " VALUES (?, ?, ?, ?, ?, ?, ?, x'', ?, 0, ?, 0, 0, 0, 0, ?, ?)");
  query.BindText(record.id).BindText(record.principal).Bind(int64_t{record.priority});
  query.BindBlob(record.spec.rest).BindBlob(record.question).Bind(int64_t{record.state});
  query.Bind(absl::ToUnixNanos(record.create_time)).BindText(record.engine_version);
  query.Bind(record.points).Bind(record.bytes).BindBlob(record.spec.grid);
  const absl::Status status = query.Run();
  record.sequence = database.LastInsertedRow();
  return status;
}

absl::StatusOr<std::optional<JobRecord>> FindJob(Database& database, const std::string& id,
                                                 Grid grid) {
  Query query = database.Prepare(SelectWhere("id = ?", grid));
  query.BindText(id);
  return FirstRow(query, grid);
}

absl::StatusOr<std::optional<JobRecord>> FindJobBySequence(Database& database, int64_t sequence,
                                                           Grid grid) {
  Query query = database.Prepare(SelectWhere("sequence = ?", grid));
  query.Bind(sequence);
  return FirstRow(query, grid);
}

absl::StatusOr<std::optional<JobRecord>> FindAnswer(Database& database,
                                                    const std::string& principal,
                                                    const std::string& question) {
  if (question.empty()) return std::nullopt;
  Query query =
      database.Prepare(SelectWhere("principal = ? AND question = ? AND question <> x'' AND state = "
                                   "? AND expired_time IS NULL ORDER BY sequence LIMIT 1",
                                   Grid::kIncluded));
  query.BindText(principal).BindBlob(question).Bind(int64_t{v1::EnsembleJob::SUCCEEDED});
  return FirstRow(query, Grid::kIncluded);
}

absl::StatusOr<Load> ActiveLoad(Database& database, const std::optional<std::string>& principal) {
  Query query = database.Prepare(
      absl::StrCat("SELECT count(*), coalesce(sum(points), 0) FROM jobs WHERE state IN (",
                   kActiveStates, ")", principal ? " AND principal = ?" : ""));
  if (principal) query.BindText(*principal);
  const absl::StatusOr<bool> row = query.Step();
  if (!row.ok()) return row.status();
  return Load{.jobs = query.Integer(0), .points = query.Integer(1)};
}

absl::StatusOr<std::map<std::string, PrincipalJobs>> CountJobsByPrincipal(Database& database) {
  Query query = database.Prepare(
      "SELECT principal, count(*), sum(bytes), sum(state = 1), sum(state = 2), sum(state = 3)"
      " FROM jobs GROUP BY principal");
  std::map<std::string, PrincipalJobs> by_principal;
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return by_principal;
    by_principal[query.Bytes(0)] = {.stored = query.Integer(1),
                                    .bytes = query.Integer(2),
                                    .queued = query.Integer(3),
                                    .running = query.Integer(4),
                                    .cancelling = query.Integer(5)};
  }
}

absl::Status ReadJobs(Database& database, const std::optional<std::string>& principal,
                      int64_t before, Grid grid, const std::function<bool(JobRecord job)>& on_job) {
  Query query = database.Prepare(
      SelectWhere(principal ? "principal = ? AND sequence < ? ORDER BY sequence DESC"
                            : "sequence < ? ORDER BY sequence DESC",
                  grid));
  if (principal) query.BindText(*principal);
  query.Bind(before);
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row || !on_job(RecordOf(query, grid))) return absl::OkStatus();
  }
}

absl::StatusOr<std::vector<JobRecord>> ListUnfinishedJobs(Database& database) {
  Query query = database.Prepare(absl::StrCat(SelectWhere("state IN (", Grid::kIncluded),
                                              kActiveStates, ") ORDER BY sequence"));
  return AllRows(query, Grid::kIncluded);
}

absl::StatusOr<bool> BeginJob(Database& database, int64_t sequence, absl::Time now) {
  Query query = database.Prepare(
      "UPDATE jobs SET state = ?, start_time = ? WHERE sequence = ? AND state = ?");
  query.Bind(int64_t{v1::EnsembleJob::RUNNING}).Bind(absl::ToUnixNanos(now));
  query.Bind(sequence).Bind(int64_t{v1::EnsembleJob::QUEUED});
  return HasChanged(database, query);
}

absl::StatusOr<bool> BeginCancellation(Database& database, int64_t sequence,
                                       const std::string& request_id) {
  Query query = database.Prepare(
      "UPDATE jobs SET state = ?, cancel_request_id = ? WHERE sequence = ? AND state IN (?, ?)");
  query.Bind(int64_t{v1::EnsembleJob::CANCELLING});
  BindTextOrNull(query, request_id);
  query.Bind(sequence);
  query.Bind(int64_t{v1::EnsembleJob::QUEUED}).Bind(int64_t{v1::EnsembleJob::RUNNING});
  return HasChanged(database, query);
}

absl::StatusOr<std::optional<JobRecord>> EndJob(Database& database, int64_t sequence,
                                                const JobEnd& end) {
  Query query = database.Prepare(
      absl::StrCat("UPDATE jobs SET state = iif(state = ?, ?, ?), end_time = ?,"
                   " error = iif(state = ?, x'', ?), points_done = ?, samples = ?, work = ?,"
                   " bytes = ? WHERE sequence = ? AND state IN (",
                   kActiveStates, ")"));
  query.Bind(int64_t{v1::EnsembleJob::CANCELLING}).Bind(int64_t{v1::EnsembleJob::CANCELLED});
  query.Bind(int64_t{end.state}).Bind(absl::ToUnixNanos(end.time));
  query.Bind(int64_t{v1::EnsembleJob::CANCELLING}).BindBlob(end.error).Bind(end.points_done);
  query.Bind(end.samples).Bind(end.work).Bind(end.bytes).Bind(sequence);
  const absl::StatusOr<bool> has_ended = HasChanged(database, query);
  if (!has_ended.ok()) return has_ended.status();
  if (!*has_ended) return std::nullopt;
  for (const char* sql : kDropUnfinished) {
    const absl::Status dropped = RunFor(database, sequence, sql);
    if (!dropped.ok()) return dropped;
  }
  return FindJobBySequence(database, sequence, Grid::kIncluded);
}

absl::Status RestartJob(Database& database, int64_t sequence, const std::string& engine_version,
                        const std::string& question) {
  for (const char* sql :
       {kDropUnfinished[0], kDropUnfinished[1], "DELETE FROM results WHERE job = ?",
        "DELETE FROM details WHERE job = ?"}) {
    const absl::Status status = RunFor(database, sequence, sql);
    if (!status.ok()) return status;
  }
  return database
      .Prepare(
          "UPDATE jobs SET engine_version = ?, question = ?, restarts = restarts + 1"
          " WHERE sequence = ?")
      .BindText(engine_version)
      .BindBlob(question)
      .Bind(sequence)
      .Run();
}

absl::Status PinJob(Database& database, int64_t sequence, bool pinned) {
  return database.Prepare("UPDATE jobs SET pinned = ? WHERE sequence = ?")
      .Bind(int64_t{pinned})
      .Bind(sequence)
      .Run();
}

absl::StatusOr<std::vector<JobSize>> ListExpirable(Database& database, absl::Time ended_before,
                                                   int most) {
  return Sizes(database, kExpirable, ended_before, most);
}

absl::StatusOr<std::vector<JobSize>> ListExpired(Database& database, int most) {
  return Sizes(database, "expired_time IS NOT NULL", absl::InfiniteFuture(), most);
}

absl::StatusOr<int64_t> CountExpirable(Database& database, absl::Time ended_before) {
  Query query = database.Prepare(
      absl::StrCat("SELECT count(*) FROM jobs WHERE ", kExpirable, " AND end_time < ?"));
  const absl::StatusOr<bool> row = query.Bind(absl::ToUnixNanos(ended_before)).Step();
  if (!row.ok()) return row.status();
  return query.Integer(0);
}

absl::Status ExpireJob(Database& database, int64_t sequence, absl::Time now) {
  Query query = database.Prepare(
      "UPDATE jobs SET expired_time = ?, bytes = length(spec) + length(grid)"
      " WHERE sequence = ? AND pinned = 0");
  query.Bind(absl::ToUnixNanos(now)).Bind(sequence);
  const absl::StatusOr<bool> has_expired = HasChanged(database, query);
  if (!has_expired.ok() || !*has_expired) return has_expired.status();
  return RunFor(database, sequence, kDropResults);
}

absl::Status DeleteJob(Database& database, int64_t sequence) {
  for (const char* sql :
       {kDropUnfinished[0], kDropUnfinished[1], kDropResults, "DELETE FROM requests WHERE job = ?",
        "DELETE FROM jobs WHERE sequence = ?"}) {
    const absl::Status status = RunFor(database, sequence, sql);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace ballpiston::server
