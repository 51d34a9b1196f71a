// The active jobs of this process: their numbers in memory, and their runs in the scheduler.
//
// A job is added before its row is committed, and removed after its end is committed: an active row
// whose job is not here has ended since it was read. Thread-safe.
//
// At the start the unfinished jobs of an earlier process are resumed (resume_jobs.cc). Finished
// points stay, and unfinished points resume from their checkpoints. A job of another engine version
// is computed again. A job ends at once if it was being cancelled, if it cannot be read, or if the
// engine crashed too often while it was computed (compute/crash_record.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/ensemble/ensemble_spec.h"
#include "server/book/job.h"
#include "server/book/job_journal.h"
#include "server/compute/crash_record.h"
#include "server/compute/scheduler.h"
#include "server/mutex.h"
#include "server/store/store.h"

namespace ballpiston::server {

// The name of the job's run. It distinguishes a job from another job with the same sequence (before
// the store was restored from a backup), and from the same job under an older engine.
RunName RunOf(const JobRecord& record);

// The number of jobs that ended in this process, by their last state.
using EndedJobs = std::map<JobState, int64_t>;

class ActiveJobs {
 public:
  // All these must outlive this.
  ActiveJobs(Store& store, Scheduler& scheduler, CrashRecord& crashes)
      : store_(store), scheduler_(scheduler), crashes_(crashes) {}

  // Returns when all changes of the jobs' states are on disk. Call before anything else.
  absl::Status Resume();

  std::shared_ptr<Job> Add(const JobRecord& record);
  // No effect if the job is not here.
  void Remove(const std::string& id);
  std::shared_ptr<Job> Find(const std::string& id) const;  // null: it is not here

  // Sets the rest of the request: what identifies the run, and its journal.
  void StartRun(const std::shared_ptr<Job>& job, RunRequest request);

  // Ends all waits for a change of a job.
  void StopWaiting();

  size_t size() const;
  int64_t bytes() const;  // in the store, without checkpoints
  EndedJobs ended() const;

 private:
  // The end that the journal records removes the job. `resumed`: as of JobJournal.
  std::shared_ptr<JobJournal> JournalOf(const std::shared_ptr<Job>& job, bool resumed);
  void OnEnded(const JobRecord& ended);

  absl::Status RestartOlder(std::vector<JobRecord>& unfinished);
  absl::Status ResumeJob(const JobRecord& record);
  absl::Status ResumeRun(const JobRecord& record, EnsembleSpec spec);
  // Ends the job like a run that has nothing left to compute.
  absl::Status End(const JobRecord& record, const absl::Status& why);
  absl::Status EndCrashed(const JobRecord& record);
  // Empty unless the job was being computed at two deaths of the process.
  std::optional<Suspicion> SuspicionOf(const JobRecord& record);

  Store& store_;
  Scheduler& scheduler_;
  CrashRecord& crashes_;
  mutable Mutex mutex_;
  std::map<std::string, std::shared_ptr<Job>> jobs_ ABSL_GUARDED_BY(mutex_);  // by id
  EndedJobs ended_ ABSL_GUARDED_BY(mutex_) = {{v1::EnsembleJob::SUCCEEDED, 0},
                                              {v1::EnsembleJob::FAILED, 0},
                                              {v1::EnsembleJob::CANCELLED, 0}};
};

}  // namespace ballpiston::server
