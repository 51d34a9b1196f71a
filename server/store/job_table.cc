#include "server/store/job_table.h"

#include "absl/strings/str_cat.h"
#include "server/convert/timestamp.h"
#include "server/store/job_name.h"

namespace ballpiston::server {
namespace {

// QUEUED, RUNNING, CANCELLING.
constexpr char kActiveStates[] = "1, 2, 3";
static_assert(v1::EnsembleJob::QUEUED == 1 && v1::EnsembleJob::RUNNING == 2 &&
              v1::EnsembleJob::CANCELLING == 3);
static_assert(v1::EnsembleJob::SUCCEEDED == 4);

// The schema has an index for each condition.
const char* ConditionOf(Removable what) {
  return what == Removable::kResults ? "end_time IS NOT NULL AND expired = 0 AND pinned = 0"
                                     : "expired = 1";
}

// The grid is the last column, because SQLite reads a row up to the columns that are asked for.
std::string SelectJobs(Grid grid, const std::string& condition) {
  return absl::StrCat(
      "SELECT sequence, id, principal, state, payload, question, family, restarts,"
      " cancel_request_id, message, ",
      grid == Grid::kIncluded ? "grid" : "x''", " FROM jobs WHERE ", condition);
}

// A row of SelectJobs.
JobRecord RecordOf(const Query& row) {
  JobRecord record;
  std::string principal, job, grid;
  JobState state = {};
  row.ReadInto(record.sequence, record.id, principal, state, record.payload, record.question,
               record.family, record.restarts, record.cancel_request_id, job, grid);
  const bool is_read = record.job.ParseFromString(job) &&
                       (grid.empty() || record.job.mutable_spec()->MergeFromString(grid));
  if (!is_read) record.job.clear_spec();
  record.job.set_name(JobName(record.id));
  record.job.set_principal(principal);
  record.job.set_state(state);
  return record;
}

std::string BytesWithoutGrid(v1::EnsembleJob job) {
  if (job.has_spec()) job.mutable_spec()->clear_grid();
  return job.SerializeAsString();
}

// A specification that has only the grid.
std::string BytesOfGrid(const v1::EnsembleSpec& spec) {
  v1::EnsembleSpec grid;
  if (spec.has_grid()) *grid.mutable_grid() = spec.grid();
  return grid.SerializeAsString();
}

template <typename... Values>
std::optional<JobRecord> FirstJob(Database& database, Grid grid, const std::string& condition,
                                  const Values&... values) {
  Query query = database.Select(SelectJobs(grid, condition), values...);
  return query.Next() ? std::optional(RecordOf(query)) : std::nullopt;
}

void DropCheckpoints(Database& database, int64_t sequence) {
  database.Run("DELETE FROM checkpoints WHERE job = ?", sequence);
  database.Run("DELETE FROM chunks WHERE job = ?", sequence);
}

// The sweeper removes the results.
void DropResults(Database& database, int64_t sequence) {
  database.Run("INSERT OR IGNORE INTO dropped (job) VALUES (?)", sequence);
}

template <typename... Values>
std::vector<JobRecord> AllJobs(Database& database, Grid grid, const std::string& condition,
                               const Values&... values) {
  std::vector<JobRecord> records;
  Query query = database.Select(SelectJobs(grid, condition), values...);
  while (query.Next()) records.push_back(RecordOf(query));
  return records;
}

}  // namespace

void InsertJob(Database& database, JobRecord& record) {
  record.job.set_state(v1::EnsembleJob::QUEUED);
  database.Run(
      "INSERT INTO jobs (id, principal, request_id, payload, points, grid)"
      " VALUES (?, ?, ?, ?, ?, ?)",
      record.id, record.job.principal(), record.request_id, Blob{record.payload},
      record.job.progress().points(), Blob{BytesOfGrid(record.job.spec())});
  record.sequence = database.LastInsertedRow();
  UpdateJob(database, record);
}

void UpdateJob(Database& database, const JobRecord& record) {
  const v1::EnsembleJob& job = record.job;
  std::optional<absl::Time> end_time;
  if (job.has_end_time()) end_time = TimeOf(job.end_time());
  database.Run(
      "UPDATE jobs SET question = ?, family = ?, restarts = ?, cancel_request_id = ?, state = ?,"
      " end_time = coalesce(?, end_time), expired = ?, pinned = ?, bytes = ?, points_done = ?,"
      " samples = ?, message = ? WHERE sequence = ?",
      Blob{record.question}, Blob{record.family}, record.restarts, record.cancel_request_id,
      job.state(), end_time, job.results_expired(), job.pinned(), StoredBytesOf(job),
      job.progress().points_done(), job.progress().samples(), Blob{BytesWithoutGrid(job)},
      record.sequence);
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

std::optional<JobRecord> FindJobOfCancellation(Database& database, const std::string& principal,
                                               const std::string& request_id) {
  return FirstJob(database, Grid::kLeftOut,
                  "principal = ? AND cancel_request_id = ? AND cancel_request_id <> ''", principal,
                  request_id);
}

std::optional<JobRecord> FindAnswer(Database& database, const std::string& principal,
                                    const std::string& question,
                                    absl::FunctionRef<bool(const v1::EnsembleJob&)> accepts) {
  if (question.empty()) return std::nullopt;
  Query query =
      database.Select(SelectJobs(Grid::kLeftOut,
                                 "sequence IN (SELECT sequence FROM jobs WHERE principal = ?"
                                 " AND question = ? AND question <> x'' AND state = 4"
                                 " AND expired = 0 ORDER BY sequence DESC LIMIT ?)"
                                 " ORDER BY pinned DESC, end_time DESC, sequence DESC"),
                      principal, Blob{question}, kMostAnswers);
  while (query.Next()) {
    const JobRecord record = RecordOf(query);
    if (accepts(record.job)) return FindJobBySequence(database, record.sequence);
  }
  return std::nullopt;
}

std::vector<JobRecord> FindFamily(Database& database, const std::string& principal,
                                  const std::string& family) {
  return AllJobs(database, Grid::kLeftOut,
                 "principal = ? AND family = ? AND family <> x'' AND state = 4"
                 " AND expired = 0 ORDER BY samples DESC, sequence LIMIT ?",
                 principal, Blob{family}, kMostOfAFamily);
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
  return AllJobs(database, Grid::kIncluded,
                 absl::StrCat("state IN (", kActiveStates, ") ORDER BY sequence"));
}

bool BeginJob(Database& database, int64_t sequence, absl::Time now) {
  std::optional<JobRecord> record = FindJobBySequence(database, sequence);
  if (!record || record->job.state() != v1::EnsembleJob::QUEUED) return false;
  record->job.set_state(v1::EnsembleJob::RUNNING);
  SetTime(now, record->job.mutable_start_time());
  UpdateJob(database, *record);
  return true;
}

bool BeginCancellation(Database& database, JobRecord& record, const std::string& request_id) {
  const JobState state = record.job.state();
  if (state != v1::EnsembleJob::QUEUED && state != v1::EnsembleJob::RUNNING) return false;
  record.job.set_state(v1::EnsembleJob::CANCELLING);
  record.cancel_request_id = request_id;
  UpdateJob(database, record);
  return true;
}

std::optional<JobRecord> EndJob(Database& database, int64_t sequence, const JobEnd& end) {
  std::optional<JobRecord> record = FindJobBySequence(database, sequence);
  if (!record || HasEnded(record->job.state())) return std::nullopt;
  v1::EnsembleJob& job = record->job;
  const bool is_cancelled = job.state() == v1::EnsembleJob::CANCELLING;
  job.set_state(is_cancelled ? v1::EnsembleJob::CANCELLED : end.state);
  SetTime(end.time, job.mutable_end_time());
  if (job.state() == v1::EnsembleJob::FAILED) *job.mutable_error() = end.error;
  SetNumbers(end.numbers, job);
  UpdateJob(database, *record);
  DropCheckpoints(database, sequence);
  return record;
}

void RestartJob(Database& database, const JobRecord& record) {
  DropCheckpoints(database, record.sequence);
  database.Run("DELETE FROM results WHERE job = ?", record.sequence);
  UpdateJob(database, record);
}

std::vector<JobSize> ListRemovable(Database& database, Removable what, absl::Time ended_before,
                                   const std::string& principal, int most) {
  std::vector<JobSize> jobs;
  Query query = database.Select(
      absl::StrCat("SELECT sequence, bytes FROM jobs WHERE ", ConditionOf(what),
                   " AND end_time < ? AND ? IN ('', principal) ORDER BY end_time LIMIT ?"),
      ended_before, principal, most);
  while (query.Next()) jobs.push_back({query.Get<int64_t>(0), query.Get<int64_t>(1)});
  return jobs;
}

int64_t CountExpirable(Database& database, absl::Time ended_before) {
  return database.Integer(absl::StrCat("SELECT count(*) FROM jobs WHERE ",
                                       ConditionOf(Removable::kResults), " AND end_time < ?"),
                          ended_before);
}

std::vector<std::string> PrincipalsBySize(Database& database) {
  std::vector<std::string> principals;
  Query query =
      database.Select("SELECT principal FROM jobs GROUP BY principal ORDER BY sum(bytes) DESC");
  while (query.Next()) principals.push_back(query.Get<std::string>(0));
  return principals;
}

int64_t PinnedBytes(Database& database, const std::string& principal) {
  return database.Integer("SELECT sum(bytes) FROM jobs WHERE pinned = 1 AND principal = ?",
                          principal);
}

int64_t PinnedBytesOfEndedJobs(Database& database) {
  return database.Integer(absl::StrCat(
      "SELECT sum(bytes) FROM jobs WHERE pinned = 1 AND state NOT IN (", kActiveStates, ")"));
}

void ExpireJob(Database& database, int64_t sequence) {
  std::optional<JobRecord> record = FindJobBySequence(database, sequence);
  if (!record || record->job.pinned()) return;
  record->job.set_results_expired(true);
  record->job.set_stored_bytes(static_cast<double>(BytesOfJob(record->job)));
  UpdateJob(database, *record);
  DropResults(database, sequence);
}

void DeleteJob(Database& database, int64_t sequence) {
  DropCheckpoints(database, sequence);
  DropResults(database, sequence);
  database.Run("DELETE FROM jobs WHERE sequence = ?", sequence);
}

}  // namespace ballpiston::server
