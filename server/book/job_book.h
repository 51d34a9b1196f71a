// All jobs: the operations of the API's methods, without gRPC.
//
// A job is a row of the store. While it is active, memory also has its numbers (job.h), and the
// scheduler its run. Every method reads the job's state from the committed row, so no client sees a
// state that a restart could take back, or an older state after a newer one.
//
// Methods that write wait for the disk. Errors have reasons (server/convert/errors.h). Thread-safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/book/acceptance.h"
#include "server/book/active_jobs.h"
#include "server/book/job.h"
#include "server/book/job_list.h"
#include "server/compute/crash_record.h"
#include "server/compute/scheduler.h"
#include "server/convert/spec.h"
#include "server/door/principal.h"
#include "server/limits.h"
#include "server/mutex.h"
#include "server/store/job_table.h"
#include "server/store/store.h"

namespace ballpiston::server {

using JobsPage = PageOfJobs<v1::EnsembleJob>;

// A job's row, and its numbers in memory.
struct FoundJob {
  JobRecord record;
  std::shared_ptr<Job> active = nullptr;  // null if it has ended

  // The number of the last finished point.
  int64_t last_finished() const {
    return active != nullptr ? active->last_finished() : record.job.progress().points_done();
  }
};

// A point whose result is stored, and its number in the order of storing (point_tables.h).
struct FinishedPoint {
  int64_t number = 0;
  v1::PointResult result;  // without histograms and curves
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
  std::optional<Labels> labels = {};     // in place of all earlier ones
};

class JobBook {
 public:
  // Store and scheduler must outlive this.
  JobBook(Store& store, const Limits& limits, Scheduler& scheduler,
          std::shared_ptr<CrashRecord> crashes = std::make_shared<CrashRecord>());
  ~JobBook();  // shuts down, and closes the store

  // Resumes the unfinished jobs of an earlier process. Call before anything else.
  absl::Status Resume() { return active_.Resume(); }

  // Stops the computation, and all waits for a change of a job. Unfinished jobs stay in the store
  // as they are.
  void Shutdown();

  // `checked` is the specification of the request. Its violations are what this machine cannot do;
  // an earlier job is returned in spite of them. The request's id is in lower case. Returns an
  // earlier job if this is a retry, or if an earlier job has the same question.
  absl::StatusOr<v1::EnsembleJob> Create(const Principal& caller,
                                         const v1::CreateEnsembleJobRequest& request,
                                         const CheckedSpec& checked);

  // For all methods below, a job that the caller may not see does not exist.
  absl::StatusOr<v1::EnsembleJob> Cancel(const Principal& caller, const std::string& id,
                                         const std::string& request_id);
  absl::Status Delete(const Principal& caller, const std::string& id);
  absl::StatusOr<v1::EnsembleJob> Update(const Principal& caller, const std::string& id,
                                         const JobChange& change);

  // ---- these only read (job_book_reads.cc) ----

  absl::StatusOr<v1::EnsembleJob> Get(const Principal& caller, const std::string& id,
                                      Grid grid = Grid::kIncluded);
  absl::StatusOr<JobsPage> List(const Principal& caller, const JobsQuery& query);
  absl::StatusOr<ResultsPage> Results(const Principal& caller, const std::string& id,
                                      const ResultsQuery& query);
  absl::StatusOr<v1::PointResult> Result(const Principal& caller, const std::string& id,
                                         int64_t point);
  // The result up to now of a point that is being computed, with histograms and curves. Empty if
  // the point is not being computed.
  absl::StatusOr<std::optional<v1::PointResult>> UnfinishedResult(const Principal& caller,
                                                                  const std::string& id,
                                                                  int64_t point);

  // The job that clients see. `active`: null if it has ended.
  v1::EnsembleJob Message(const JobRecord& record, const Job* active) const;

  // ---- for watches ----

  // The job's row, read anew, and the job itself, null if it has ended. NOT_FOUND also if the
  // caller may not see it.
  absl::StatusOr<FoundJob> Find(const Principal& caller, const std::string& id, Grid grid);

  // The newest `limit` unfinished points of the job. The snapshot is at most `max_age` old.
  std::shared_ptr<const JobSnapshot> Snapshot(Job& job, std::chrono::milliseconds max_age,
                                              size_t limit) const;

  // The finished points after number `after`, in order, at most `limit`; fewer if they are large.
  // `active` is null if the job has ended. No points: there are no more, or they have expired.
  absl::StatusOr<std::vector<FinishedPoint>> FinishedAfter(const JobRecord& record,
                                                           const Job* active, int64_t after,
                                                           size_t limit);

  // ---- how long results are kept (retention.cc), and what the server's status shows ----

  // Lets results expire and deletes expired jobs, as the limits require at the time `now`. Returns
  // when nothing is left to do, or at a shutdown. Call about once a second, from one thread at a
  // time.
  void KeepLimits(absl::Time now);

  // Jobs whose results expire within a week. 0 if the store cannot be read.
  int64_t CountExpiring(absl::Time now);
  std::vector<v1::PrincipalStatus> JobsByPrincipal();  // empty if the store cannot be read
  size_t active_jobs() const { return active_.size(); }
  EndedJobs ended_jobs() const { return active_.ended(); }
  int64_t engine_crashes() const { return crashes_->counted_deaths(); }

 private:
  Acceptance NewAcceptance(const Principal& caller, const v1::CreateEnsembleJobRequest& request,
                           const CheckedSpec& checked) const;
  absl::StatusOr<v1::EnsembleJob> Answer(const Principal& caller, const JobRecord& record);
  void TellScheduler(const JobRecord& row);
  absl::StatusOr<JobRecord> ReadRecord(const Principal& caller, const std::string& id, Grid grid);
  // Adds the numbers in memory. If the job has ended since its row was read, reads the row again.
  absl::StatusOr<FoundJob> WithNumbers(const Principal& caller, JobRecord record, Grid grid);
  // The number of jobs or their results that were removed. 0: nothing is left to do.
  absl::StatusOr<size_t> EnforceRetention(absl::Time now);

  Store& store_;
  const Limits limits_;
  Scheduler& scheduler_;
  const std::shared_ptr<CrashRecord> crashes_;
  ActiveJobs active_;
  // Held from the reading of a job's row until the scheduler knows what the row says. So the
  // scheduler never gets an older row after a newer one.
  Mutex telling_;
  absl::Status limits_failure_;  // of the last call of KeepLimits
};

// The job, or an error of the database: NOT_FOUND if the caller may not see it.
JobRecord JobOf(Database& database, const Principal& caller, const std::string& id, Grid grid);

}  // namespace ballpiston::server
