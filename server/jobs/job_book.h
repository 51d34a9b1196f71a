// All jobs: the operations of the API's methods, without gRPC.
//
// A job is a row of the store. While it is active, the book also has its numbers (job.h), and the
// scheduler its run. Every method reads the job's state from the committed row, so no client sees a
// state that a restart could take back, or an older state after a newer one. A job is in the book
// before its row is committed, and until after its end is committed: an active row whose job is not
// in the book has ended since it was read.
//
// Methods that write wait for the disk. Errors have reasons (server/convert/errors.h). Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/convert/spec.h"
#include "server/door/principal.h"
#include "server/jobs/acceptance.h"
#include "server/jobs/job.h"
#include "server/jobs/job_filter.h"
#include "server/jobs/retention.h"
#include "server/limits.h"
#include "server/mutex.h"
#include "server/scheduling/crash_record.h"
#include "server/scheduling/scheduler.h"
#include "server/store/job_table.h"
#include "server/store/store.h"

namespace ballpiston::server {

// Limits of what one page reads from the store to find matching jobs. 2,000 small jobs take 4 ms;
// 16 MiB of large jobs take 12 ms.
inline constexpr int kMaxJobsRead = 2000;
inline constexpr size_t kMaxJobBytesRead = size_t{16} << 20;

inline constexpr absl::Duration kSoonToExpire = absl::Hours(7 * 24);

struct JobsQuery {
  JobFilter filter = {};
  Grid grid = Grid::kIncluded;
  int64_t before = 0;  // jobs older than this sequence, newest first
  int max_jobs = 1;
  size_t max_bytes = 0;  // ends a page that has at least one job
  // These also end a page that has no job yet. A page reads at least one job.
  int max_jobs_read = kMaxJobsRead;
  size_t max_bytes_read = kMaxJobBytesRead;
};

struct JobsPage {
  std::vector<v1::EnsembleJob> jobs;
  std::optional<int64_t> next_before;  // where the next page begins; empty: this is the last page
};

// A job's row, and its numbers in memory.
struct FoundJob {
  JobRecord record;
  std::shared_ptr<Job> active = nullptr;  // null if it has ended
};

// The data of a job that a watch needs.
struct WatchedJob : FoundJob {  // without its grid
  int64_t last_finished = 0;    // the number of its last finished point
};

struct ResultsQuery {
  int64_t first_point = 0;
  int max_points = 1;
  size_t max_bytes = 0;  // ends a page that has at least one point
  bool histograms = true;
};

struct ResultsPage {
  std::vector<v1::PointResult> points;
  std::optional<int64_t> next_point;  // empty: this is the last page
};

// The fields of a job that its owner may change; empty: not changed.
struct JobChange {
  std::optional<bool> pinned = {};
  std::optional<int32_t> priority = {};  // of an active job; has no effect on one that has ended
};

// Jobs that ended in this book's life, by state.
struct EndedJobs {
  uint64_t succeeded = 0;
  uint64_t failed = 0;
  uint64_t cancelled = 0;
};

class JobBook {
 public:
  // Store and scheduler must outlive this.
  JobBook(Store& store, const Limits& limits, Scheduler& scheduler,
          std::shared_ptr<CrashRecord> crashes = std::make_shared<CrashRecord>());
  ~JobBook();  // shuts down, and closes the store

  // Resumes the unfinished jobs of an earlier process. Call before anything else.
  absl::Status Resume();

  // Stops the computation, and all waits for a change of a job. Unfinished jobs stay in the store
  // as they are.
  void Shutdown();

  // The answer that Create would give now.
  absl::StatusOr<v1::EnsembleJob> Preview(const Principal& caller,
                                          const v1::CreateEnsembleJobRequest& request,
                                          const CheckedSpec& checked);

  // `checked` is the specification of the request, without violations; the request's id is in lower
  // case. Returns an earlier job if this is a retry, or if an earlier job has the same question.
  absl::StatusOr<v1::EnsembleJob> Create(const Principal& caller,
                                         const v1::CreateEnsembleJobRequest& request,
                                         const CheckedSpec& checked);

  // For all methods below, a job that the caller may not see does not exist.
  absl::StatusOr<v1::EnsembleJob> Get(const Principal& caller, const std::string& id,
                                      Grid grid = Grid::kIncluded);
  absl::StatusOr<JobsPage> List(const Principal& caller, const JobsQuery& query);
  absl::StatusOr<v1::EnsembleJob> Cancel(const Principal& caller, const std::string& id,
                                         const std::string& request_id);
  absl::Status Delete(const Principal& caller, const std::string& id);
  absl::StatusOr<v1::EnsembleJob> Update(const Principal& caller, const std::string& id,
                                         const JobChange& change);
  absl::StatusOr<ResultsPage> Results(const Principal& caller, const std::string& id,
                                      const ResultsQuery& query);
  absl::StatusOr<v1::PointResult> Result(const Principal& caller, const std::string& id,
                                         int64_t point);
  // The result up to now of a point that is being computed, with histograms and curves. Empty if
  // the point is not being computed.
  absl::StatusOr<std::optional<v1::PointResult>> UnfinishedResult(const Principal& caller,
                                                                  const std::string& id,
                                                                  int64_t point);

  absl::StatusOr<WatchedJob> FindWatched(const Principal& caller, const std::string& id);

  // The row of a job that is or was active, without its grid; one read serves all watches. It is
  // not older than the job's last change of state, or its last FindWatched.
  absl::StatusOr<std::shared_ptr<const StoredJob>> Stored(Job& job);

  // The job that clients see. `active`: null if it has ended.
  v1::EnsembleJob Message(const JobRecord& record, const Job* active) const;

  // The newest `limit` unfinished points of the job. The snapshot is at most `max_age` old.
  std::shared_ptr<const JobSnapshot> Snapshot(Job& job, std::chrono::milliseconds max_age,
                                              size_t limit) const;

  // The finished points after number `after`, in order, at most `limit`; fewer if they are large.
  // `active` is null if the job has ended. No points: there are no more. May read the store.
  absl::StatusOr<std::vector<FinishedPoint>> FinishedAfter(int64_t sequence, const Job* active,
                                                           int64_t after, size_t limit);

  // Lets results expire at the time `now`. Call about once a second, from one thread at a time.
  void KeepLimits(absl::Time now);

  // Jobs whose results expire within kSoonToExpire. 0 if the store cannot be read.
  int64_t CountExpiring(absl::Time now);

  size_t active_jobs() const;
  std::map<std::string, PrincipalJobs> JobsByPrincipal();  // empty if the store cannot be read
  EndedJobs ended_jobs() const;
  int64_t engine_crashes() const { return crashes_->counted_deaths(); }

 private:
  JobRecord NewRecord(const Principal& caller, const v1::CreateEnsembleJobRequest& request,
                      const CheckedSpec& checked) const;
  Acceptance NewAcceptance(const Principal& caller, const v1::CreateEnsembleJobRequest& request,
                           const CheckedSpec& checked) const;
  absl::StatusOr<v1::EnsembleJob> Answer(const Principal& caller, const Acceptance& acceptance);
  absl::Status RestartOlder(std::vector<JobRecord>& unfinished);
  absl::Status ResumeJob(const JobRecord& record);
  absl::Status EndCrashed(const JobRecord& record);
  std::optional<Suspicion> SuspicionOf(const JobRecord& record);
  absl::Status EndUnresumable(const JobRecord& record, const absl::Status& why);
  absl::Status ResumeRun(const JobRecord& record, EnsembleSpec spec);
  std::shared_ptr<Job> Register(const JobRecord& record);
  // No effect if the job is not in the book.
  void Forget(const std::string& id);
  // Sets the key and the journal of the request.
  void StartRun(std::shared_ptr<Job> job, const JobRecord& record, RunRequest request);
  void StartNewRun(std::shared_ptr<Job> job, const JobRecord& record, const CheckedSpec& checked);
  void CancelRun(const JobRecord& record);
  void OnEnded(const JobRecord& ended);
  std::shared_ptr<Job> InBook(const std::string& id) const;  // null: it is not
  absl::StatusOr<JobRecord> ReadRecord(const Principal& caller, const std::string& id, Grid grid);
  absl::StatusOr<FoundJob> Find(const Principal& caller, const std::string& id, Grid grid);
  // The record of a job whose results have not expired.
  absl::StatusOr<JobRecord> ReadRecordWithResults(const Principal& caller, const std::string& id);

  Store& store_;
  const Limits limits_;
  Scheduler& scheduler_;
  const std::shared_ptr<CrashRecord> crashes_;
  mutable Mutex mutex_;
  std::map<std::string, std::shared_ptr<Job>> active_ ABSL_GUARDED_BY(mutex_);  // by id
  Retention retention_;
  absl::Status limits_failure_;  // of the last call of KeepLimits
  std::atomic<uint64_t> succeeded_ = 0;
  std::atomic<uint64_t> failed_ = 0;
  std::atomic<uint64_t> cancelled_ = 0;
};

}  // namespace ballpiston::server
