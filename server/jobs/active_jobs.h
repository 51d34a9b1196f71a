// The active jobs of this process: their numbers in memory, and their runs in the scheduler.
//
// A job is added before its row is committed, and removed after its end is committed: an active row
// whose job is not here has ended since it was read. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "server/jobs/job.h"
#include "server/jobs/job_journal.h"
#include "server/mutex.h"
#include "server/scheduling/crash_record.h"
#include "server/scheduling/scheduler.h"
#include "server/store/store.h"

namespace ballpiston::server {

// The name of the job's run. It distinguishes a job from another job with the same sequence (before
// the store was restored from a backup), and from the same job under an older engine.
RunName RunOf(const JobRecord& record);

// Jobs that ended in this process, by state.
struct EndedJobs {
  uint64_t succeeded = 0;
  uint64_t failed = 0;
  uint64_t cancelled = 0;
};

class ActiveJobs {
 public:
  // Store and scheduler must outlive this.
  ActiveJobs(Store& store, Scheduler& scheduler) : store_(store), scheduler_(scheduler) {}

  std::shared_ptr<Job> Add(const JobRecord& record);
  // No effect if the job is not here.
  void Remove(const std::string& id);
  std::shared_ptr<Job> Find(const std::string& id) const;  // null: it is not here

  // Sets the rest of the request: what identifies the run, and its journal.
  void StartRun(const std::shared_ptr<Job>& job, RunRequest request);
  // The end that the journal records removes the job. `resumed`: as of JobJournal.
  std::shared_ptr<JobJournal> JournalOf(const std::shared_ptr<Job>& job, bool resumed);

  // Ends all waits for a change of a job.
  void StopWaiting();

  size_t size() const;
  EndedJobs ended() const;

 private:
  void OnEnded(const JobRecord& ended);

  Store& store_;
  Scheduler& scheduler_;
  mutable Mutex mutex_;
  std::map<std::string, std::shared_ptr<Job>> jobs_ ABSL_GUARDED_BY(mutex_);  // by id
  EndedJobs ended_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
