// The SQL about jobs. Each function runs inside the transaction of its caller, which handles errors
// (sqlite.h).
//
// Only these functions change a job's state. The transitions:
//
//   QUEUED -> RUNNING -> SUCCEEDED | FAILED
//   QUEUED, RUNNING -> CANCELLING -> CANCELLED
//
// QUEUED may also end at once: SUCCEEDED after a restart that found nothing left to compute, or
// FAILED. BeginJob, BeginCancellation and EndJob check the states in which they act, and have no
// effect in others. The store runs all writes in one order: if a cancellation and the end of a job
// come at the same time, one of them is first, and the first end is kept.
//
// A row has the job as a message (JobRecord::job), and columns with the values that the statements
// here and in check_store.cc search for. InsertJob and UpdateJob write both.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/time/time.h"
#include "ballpiston/v1/server.pb.h"
#include "google/rpc/status.pb.h"
#include "server/store/job_record.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

// Whether a job is read with the grid of its specification, which may be large.
enum class Grid { kLeftOut, kIncluded };

// Sets record.sequence; the job is QUEUED.
void InsertJob(Database& database, JobRecord& record);

// Writes the whole record except its grid, name, principal, request and number of points, which
// never change.
void UpdateJob(Database& database, const JobRecord& record);

std::optional<JobRecord> FindJob(Database& database, const std::string& id, Grid grid);
std::optional<JobRecord> FindJobBySequence(Database& database, int64_t sequence);

// The job that the principal's request with this id made. Empty also without an id.
std::optional<JobRecord> FindJobOfRequest(Database& database, const std::string& principal,
                                          const std::string& request_id);
// The job that the principal's request with this id cancelled. Empty also without an id.
std::optional<JobRecord> FindJobOfCancellation(Database& database, const std::string& principal,
                                               const std::string& request_id);

// The principal's job that SUCCEEDED in answering the question (JobRecord::question) and for which
// `accepts` returns true, given the job without its grid: a pinned one, else the one that ended
// last. Looks only at the kMostAnswers newest jobs.
inline constexpr int kMostAnswers = 1'000;
std::optional<JobRecord> FindAnswer(Database& database, const std::string& principal,
                                    const std::string& question,
                                    absl::FunctionRef<bool(const v1::EnsembleJob&)> accepts);

// The principal's jobs that SUCCEEDED, with this JobRecord::family and their results, without their
// grids: at most kMostOfAFamily, those with the most samples first.
inline constexpr int kMostOfAFamily = 20;
std::vector<JobRecord> FindFamily(Database& database, const std::string& principal,
                                  const std::string& family);

// The number of the principal's active jobs (neither SUCCEEDED nor FAILED nor CANCELLED), and of
// their points.
struct Load {
  int64_t jobs = 0;
  int64_t points = 0;
};
Load ActiveLoad(Database& database, const std::string& principal);

// The jobs of each principal.
std::vector<v1::PrincipalStatus> CountJobsByPrincipal(Database& database);

// Reads the jobs of one principal or of all, with a smaller sequence than `before`, newest first.
// Ends when `on_job` returns false.
void ReadJobs(Database& database, const std::optional<std::string>& principal, int64_t before,
              Grid grid, absl::FunctionRef<bool(JobRecord job)> on_job);

// The active jobs, oldest first.
std::vector<JobRecord> ListUnfinishedJobs(Database& database);

// QUEUED -> RUNNING. False in every other state.
bool BeginJob(Database& database, int64_t sequence, absl::Time now);

// QUEUED, RUNNING -> CANCELLING. False in every other state. The record was read in this
// transaction.
bool BeginCancellation(Database& database, JobRecord& record, const std::string& request_id);

struct JobEnd {
  JobState state = v1::EnsembleJob::SUCCEEDED;
  absl::Time time;
  google::rpc::Status error;  // of a job that FAILED
  JobNumbers numbers;
};

// Ends an active job and drops its checkpoints. A job that is CANCELLING becomes CANCELLED whatever
// state was requested. Returns the job's new row; empty if the job is not active.
std::optional<JobRecord> EndJob(Database& database, int64_t sequence, const JobEnd& end);

// Starts a job of another engine version again: drops its results, and updates it.
void RestartJob(Database& database, const JobRecord& record);

struct JobSize {
  int64_t sequence = 0;
  int64_t bytes = 0;  // JobNumbers::bytes
};

// Retention (book/retention.cc) may remove the results of jobs that have ended and are not pinned,
// and jobs whose results have expired.
enum class Removable { kResults, kJobs };

// At most `most` such jobs that ended before `ended_before`, of one principal or, if it is empty,
// of all. Those that ended first come first.
std::vector<JobSize> ListRemovable(Database& database, Removable what, absl::Time ended_before,
                                   const std::string& principal, int most);
int64_t CountExpirable(Database& database, absl::Time ended_before);  // Removable::kResults

// The principals with jobs; those with the most stored bytes come first.
std::vector<std::string> PrincipalsBySize(Database& database);
// The bytes of the principal's pinned jobs. The results of active jobs are not counted.
int64_t PinnedBytes(Database& database, const std::string& principal);
int64_t PinnedBytesOfEndedJobs(Database& database);  // of all principals

// After these two, the sweeper removes the results (sweeper.h); nobody can find them meanwhile.
// ExpireJob has no effect on a pinned job. It keeps the row, so retries of its request are still
// answered with the job.
void ExpireJob(Database& database, int64_t sequence);
void DeleteJob(Database& database, int64_t sequence);

}  // namespace ballpiston::server
