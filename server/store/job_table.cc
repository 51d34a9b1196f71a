#include "server/store/job_table.h"

#include <type_traits>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {
namespace {

// QUEUED, RUNNING, CANCELLING.
constexpr char kActiveStates[] = "1, 2, 3";
static_assert(v1::EnsembleJob::QUEUED == 1 && v1::EnsembleJob::RUNNING == 2 &&
              v1::EnsembleJob::CANCELLING == 3);

// Jobs whose results may expire, and those whose results have expired. Each has an index.
constexpr char kExpirable[] = "end_time IS NOT NULL AND expired_time IS NULL AND pinned = 0";
constexpr char kExpired[] = "expired_time IS NOT NULL";

// The columns of the table, one a line: name, type, and field of the row. All statements that make
// the table or handle whole rows are made of this list. The grid is the last column, because SQLite
// reads a row up to the columns that are asked for.
template <typename Record, typename Visit>
void VisitColumns(Record& job, Visit visit) {
  visit("sequence", "INTEGER PRIMARY KEY AUTOINCREMENT", job.sequence);
  visit("id", "TEXT NOT NULL UNIQUE", job.id);
  visit("principal", "TEXT NOT NULL", job.principal);
  visit("request_id", "TEXT NOT NULL", job.request_id);
  visit("payload", "BLOB NOT NULL", job.payload);
  visit("priority", "INTEGER NOT NULL", job.priority);
  visit("pinned", "INTEGER NOT NULL", job.pinned);
  visit("labels", "TEXT NOT NULL", job.labels);
  visit("bytes", "INTEGER NOT NULL", job.numbers.bytes);
  visit("spec", "BLOB NOT NULL", job.spec.rest);
  visit("question", "BLOB NOT NULL", job.question);
  visit("family", "BLOB NOT NULL", job.family);
  visit("continues", "TEXT NOT NULL", job.continues);
  visit("continued_samples", "REAL NOT NULL", job.continued_samples);
  visit("state", "INTEGER NOT NULL", job.state);
  visit("create_time", "INTEGER NOT NULL", job.create_time);
  visit("start_time", "INTEGER", job.start_time);
  visit("end_time", "INTEGER", job.end_time);
  visit("expired_time", "INTEGER", job.expired_time);
  visit("error", "BLOB NOT NULL", job.error);
  visit("engine_version", "TEXT NOT NULL", job.engine_version);
  visit("restarts", "INTEGER NOT NULL", job.restarts);
  visit("cancel_request_id", "TEXT NOT NULL", job.cancel_request_id);
  visit("points", "INTEGER NOT NULL", job.points);
  visit("points_done", "INTEGER NOT NULL", job.numbers.points_done);
  visit("samples", "REAL NOT NULL", job.numbers.samples);
  visit("work", "REAL NOT NULL", job.numbers.work);
  visit("grid", "BLOB NOT NULL", job.spec.grid);
}

// What `text_of` makes of each column's name and type, with commas.
template <typename TextOf>
std::string EachColumn(TextOf text_of) {
  std::vector<std::string> texts;
  const JobRecord any;
  VisitColumns(any, [&](absl::string_view name, absl::string_view type, const auto&) {
    texts.push_back(text_of(name, type));
  });
  return absl::StrJoin(texts, ", ");
}

std::string ColumnNames(Grid grid) {
  return EachColumn([grid](absl::string_view name, absl::string_view) {
    const bool is_left_out = name == "grid" && grid == Grid::kLeftOut;
    return std::string(is_left_out ? "x''" : name);
  });
}

std::string SelectJobs(Grid grid, const std::string& condition) {
  return absl::StrCat("SELECT ", ColumnNames(grid), " FROM jobs WHERE ", condition);
}

// A row of SelectJobs.
JobRecord RecordOf(const Query& row) {
  JobRecord job;
  int column = 0;
  VisitColumns(job, [&](absl::string_view, absl::string_view, auto& field) {
    field = row.Get<std::remove_reference_t<decltype(field)>>(column++);
  });
  job.numbers.points_computed = static_cast<double>(job.numbers.points_done);
  return job;
}

template <typename Value>
void BindColumn(Query& query, absl::string_view type, const Value& value) {
  if constexpr (std::is_same_v<Value, std::string>) {
    if (absl::StartsWith(type, "BLOB")) return query.Bind(Blob{value});
  }
  query.Bind(value);
}

template <typename... Values>
std::optional<JobRecord> FirstJob(Database& database, Grid grid, const std::string& condition,
                                  const Values&... values) {
  Query query = database.Select(SelectJobs(grid, condition), values...);
  return query.Next() ? std::optional(RecordOf(query)) : std::nullopt;
}

// Updates one job. False: the job does not meet the condition.
template <typename... Values>
bool Update(Database& database, const std::string& sql, const Values&... values) {
  database.Run(sql, values...);
  return database.RowsChanged() == 1;
}

void DropCheckpoints(Database& database, int64_t sequence) {
  database.Run("DELETE FROM checkpoints WHERE job = ?", sequence);
  database.Run("DELETE FROM chunks WHERE job = ?", sequence);
}

// The sweeper removes the results.
void DropResults(Database& database, int64_t sequence) {
  database.Run("INSERT OR IGNORE INTO dropped (job) VALUES (?)", sequence);
}

// The jobs that ended first.
std::vector<JobSize> Sizes(Database& database, const char* condition, absl::Time ended_before,
                           int most) {
  std::vector<JobSize> sizes;
  Query query = database.Select(absl::StrCat("SELECT sequence, bytes FROM jobs WHERE ", condition,
                                             " AND end_time < ? ORDER BY end_time LIMIT ?"),
                                ended_before, most);
  while (query.Next()) sizes.push_back({query.Get<int64_t>(0), query.Get<int64_t>(1)});
  return sizes;
}

}  // namespace

std::string JobColumns() {
  return EachColumn(
      [](absl::string_view name, absl::string_view type) { return absl::StrCat(name, " ", type); });
}

void InsertJob(Database& database, JobRecord& record) {
  const std::string marks = EachColumn([](absl::string_view name, absl::string_view) {
    return std::string(name == "sequence" ? "NULL" : "?");
  });
  Query query = database.Select(
      absl::StrCat("INSERT INTO jobs (", ColumnNames(Grid::kIncluded), ") VALUES (", marks, ")"));
  VisitColumns(record, [&](absl::string_view name, absl::string_view type, const auto& field) {
    if (name != "sequence") BindColumn(query, type, field);
  });
  query.Next();
  record.sequence = database.LastInsertedRow();
}

std::optional<JobRecord> FindJob(Database& database, const std::string& id, Grid grid) {
  return FirstJob(database, grid, "id = ?", id);
}

std::optional<JobRecord> FindJobBySequence(Database& database, int64_t sequence) {
  return FirstJob(database, Grid::kIncluded, "sequence = ?", sequence);
}

std::optional<JobRecord> FindJobOfRequest(Database& database, const std::string& principal,
                                          const std::string& request_id) {
  return FirstJob(database, Grid::kIncluded,
                  "principal = ? AND request_id = ? AND request_id <> ''", principal, request_id);
}

std::optional<JobRecord> FindAnswer(Database& database, const std::string& principal,
                                    const std::string& question,
                                    absl::FunctionRef<bool(const std::string& labels)> accepts) {
  if (question.empty()) return std::nullopt;
  Query query = database.Select(
      "SELECT sequence, labels FROM jobs WHERE principal = ? AND question = ? AND question <> x''"
      " AND state = ? AND expired_time IS NULL ORDER BY sequence",
      principal, Blob{question}, v1::EnsembleJob::SUCCEEDED);
  while (query.Next()) {
    if (!accepts(query.Get<std::string>(1))) continue;
    return FindJobBySequence(database, query.Get<int64_t>(0));
  }
  return std::nullopt;
}

std::vector<JobRecord> FindFamily(Database& database, const std::string& principal,
                                  const std::string& family) {
  std::vector<JobRecord> records;
  if (family.empty()) return records;
  Query query = database.Select(
      SelectJobs(Grid::kLeftOut,
                 "principal = ? AND family = ? AND family <> x'' AND state = ?"
                 " AND expired_time IS NULL ORDER BY samples DESC, sequence LIMIT ?"),
      principal, Blob{family}, v1::EnsembleJob::SUCCEEDED, kMostOfAFamily);
  while (query.Next()) records.push_back(RecordOf(query));
  return records;
}

Load ActiveLoad(Database& database, const std::string& principal) {
  Load load;
  Query query = database.Select(absl::StrCat("SELECT count(*), sum(points) FROM jobs"
                                             " WHERE principal = ? AND state IN (",
                                             kActiveStates, ")"),
                                principal);
  if (query.Next()) query.ReadInto(load.jobs, load.points);
  return load;
}

std::vector<v1::PrincipalStatus> CountJobsByPrincipal(Database& database) {
  std::vector<v1::PrincipalStatus> principals;
  Query query = database.Select(
      "SELECT principal, count(*), sum(bytes), sum(state = 1), sum(state IN (2, 3))"
      " FROM jobs GROUP BY principal ORDER BY principal");
  while (query.Next()) {
    v1::PrincipalStatus& principal = principals.emplace_back();
    principal.set_principal(query.Get<std::string>(0));
    principal.set_stored_jobs(query.Get<double>(1));
    principal.set_stored_bytes(query.Get<double>(2));
    principal.set_queued_jobs(query.Get<double>(3));
    principal.set_running_jobs(query.Get<double>(4));
  }
  return principals;
}

void ReadJobs(Database& database, const std::optional<std::string>& principal, int64_t before,
              Grid grid, absl::FunctionRef<bool(JobRecord job)> on_job) {
  const std::string older = "sequence < ? ORDER BY sequence DESC";
  Query query = principal ? database.Select(SelectJobs(grid, "principal = ? AND " + older),
                                            *principal, before)
                          : database.Select(SelectJobs(grid, older), before);
  while (query.Next() && on_job(RecordOf(query))) continue;
}

std::vector<JobRecord> ListUnfinishedJobs(Database& database) {
  std::vector<JobRecord> records;
  Query query = database.Select(SelectJobs(
      Grid::kIncluded, absl::StrCat("state IN (", kActiveStates, ") ORDER BY sequence")));
  while (query.Next()) records.push_back(RecordOf(query));
  return records;
}

bool BeginJob(Database& database, int64_t sequence, absl::Time now) {
  return Update(database,
                "UPDATE jobs SET state = ?, start_time = ? WHERE sequence = ? AND state = ?",
                v1::EnsembleJob::RUNNING, now, sequence, v1::EnsembleJob::QUEUED);
}

bool BeginCancellation(Database& database, int64_t sequence, const std::string& request_id) {
  return Update(database,
                "UPDATE jobs SET state = ?, cancel_request_id = ?"
                " WHERE sequence = ? AND state IN (?, ?)",
                v1::EnsembleJob::CANCELLING, request_id, sequence, v1::EnsembleJob::QUEUED,
                v1::EnsembleJob::RUNNING);
}

std::optional<JobRecord> EndJob(Database& database, int64_t sequence, const JobEnd& end) {
  const bool has_ended = Update(
      database,
      absl::StrCat("UPDATE jobs SET state = iif(state = ?1, ?2, ?3), end_time = ?4,"
                   " error = iif(state = ?1, x'', ?5), points_done = ?6, samples = ?7, work = ?8,"
                   " bytes = ?9 WHERE sequence = ?10 AND state IN (",
                   kActiveStates, ")"),
      v1::EnsembleJob::CANCELLING, v1::EnsembleJob::CANCELLED, end.state, end.time, Blob{end.error},
      end.numbers.points_done, end.numbers.samples, end.numbers.work, end.numbers.bytes, sequence);
  if (!has_ended) return std::nullopt;
  DropCheckpoints(database, sequence);
  return FindJobBySequence(database, sequence);
}

void RestartJob(Database& database, const JobRecord& record) {
  const int64_t sequence = record.sequence;
  DropCheckpoints(database, sequence);
  database.Run("DELETE FROM results WHERE job = ?", sequence);
  database.Run(
      "UPDATE jobs SET engine_version = ?, question = ?, family = ?, continues = '',"
      " continued_samples = 0, restarts = restarts + 1 WHERE sequence = ?",
      record.engine_version, Blob{record.question}, Blob{record.family}, record.sequence);
}

void UpdateJob(Database& database, const JobRecord& record) {
  database.Run("UPDATE jobs SET pinned = ?, priority = ?, labels = ? WHERE sequence = ?",
               record.pinned, record.priority, record.labels, record.sequence);
}

std::vector<JobSize> ListExpirable(Database& database, absl::Time ended_before, int most) {
  return Sizes(database, kExpirable, ended_before, most);
}

std::vector<JobSize> ListExpired(Database& database, int most) {
  return Sizes(database, kExpired, absl::InfiniteFuture(), most);
}

int64_t RemovableBytes(Database& database) {
  constexpr char kSum[] = "SELECT sum(bytes) FROM jobs WHERE ";
  return database.Integer(absl::StrCat(kSum, kExpirable)) +
         database.Integer(absl::StrCat(kSum, kExpired));
}

int64_t CountExpirable(Database& database, absl::Time ended_before) {
  return database.Integer(
      absl::StrCat("SELECT count(*) FROM jobs WHERE ", kExpirable, " AND end_time < ?"),
      ended_before);
}

void ExpireJob(Database& database, int64_t sequence, absl::Time now) {
  const bool has_expired =
      Update(database,
             "UPDATE jobs SET expired_time = ?, bytes = length(spec) + length(grid)"
             " WHERE sequence = ? AND pinned = 0",
             now, sequence);
  if (has_expired) DropResults(database, sequence);
}

void DeleteJob(Database& database, int64_t sequence) {
  DropCheckpoints(database, sequence);
  DropResults(database, sequence);
  database.Run("DELETE FROM jobs WHERE sequence = ?", sequence);
}

}  // namespace ballpiston::server
