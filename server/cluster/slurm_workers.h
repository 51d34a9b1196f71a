// Keeps workers of a shared folder in the queue of a Slurm cluster: as many as there are leases, at
// most --slurm-workers.
//
// The workers are tasks of job arrays. They are all alike, and Slurm knows nothing of leases. So it
// does not matter which of them Slurm loses, starts twice or never starts: the next query of the
// queue counts those that are there, and the difference is submitted. All workers of a server have
// one job name. One query in 30 s, fewer after an error; none while there is no work, no
// worker in the queue and no problem. If two queries in turn find no leases, all workers are
// cancelled; a server that has just started has no leases yet. Thread-safe. One thread, because
// Slurm's tools may block for minutes.
//
// At a query the number of submitted workers depends on the state of the earlier ones:
//
//   state     | entered by                                                 | submitted
//   working   | the start, a lease that one of them took, or a query that  | those missing,
//             | finds as many as there are leases                          | at most `step_`
//   failing   | one would wait for ever (those that wait are cancelled);   | one, for a trial
//             | or some have ended without taking a lease (`submitted_`),  |
//             | and none is left, or it is the second time (`some_ended_`) |
//   on trial  | the submission of this one                                 | none
//
// `step_` is --slurm-workers at first. A failure makes it 1, a refusal by Slurm half of the number
// that was missing, and each submission that Slurm accepts doubles it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/cluster/folder_executor.h"
#include "server/mutex.h"
#include "server/periodic_thread.h"

namespace ballpiston::server {

struct SlurmOptions {
  std::string partition = {};  // these three are empty for the cluster's defaults
  std::string account = {};
  std::string cluster = {};
  int64_t time_limit_minutes = 60;
  std::vector<std::string> sbatch_options = {};  // further words for sbatch
  size_t workers = 1000;                         // that wait or run at a time
  size_t max_array_size = 1000;                  // Slurm's MaxArraySize, less one
  std::chrono::milliseconds query_interval{30'000};
};

// The server's workers in Slurm's queue.
struct SlurmQueue {
  size_t waiting = 0;
  size_t running = 0;
  std::string never = {};  // why one of them waits for ever; empty: none does
};

struct SlurmStatus {
  std::string problem = {};  // empty: none
  SlurmQueue queue;          // by Slurm's last answer
  double queries = 0;        // since the start
};

// The lines of `squeue --noheader --array --format=kQueueFormat`. Lines that cannot be read are
// left out.
inline constexpr absl::string_view kQueueFormat = "%T|%r";
SlurmQueue ParseQueue(absl::string_view lines);

// Slurm's command-line tools. Tests have others.
class SlurmTools {
 public:
  // `name`: of the jobs. `folder`: the shared one.
  SlurmTools(const SlurmOptions& options, std::string name, std::string folder);
  virtual ~SlurmTools() = default;

  // The message of an error is Slurm's own. Slurm may have accepted the array nevertheless.
  virtual absl::Status Submit(size_t workers);
  virtual absl::StatusOr<SlurmQueue> Query();
  virtual absl::Status Cancel(bool also_running);  // the workers that wait, or all

 private:
  // Runs the tool and returns what it prints. The tool is killed if it does not end within `limit`.
  absl::StatusOr<std::string> Run(std::vector<std::string> words, std::chrono::seconds limit) const;

  const SlurmOptions options_;
  const std::string name_;
  const std::string folder_;
};

// The longest chunk, in seconds, that a worker with this time limit can be expected to complete.
double LongestChunk(const SlurmOptions& options);

class SlurmWorkers {
 public:
  // `work`: what is in the folder now. `ready`: makes the folder ready for a worker.
  SlurmWorkers(const SlurmOptions& options, std::unique_ptr<SlurmTools> tools,
               std::function<FolderStatus()> work, std::function<absl::Status()> ready);
  // Waits for a tool that runs. The workers continue.
  ~SlurmWorkers() = default;

  void Start();

  // What Start calls from its thread every second. Tests call it themselves.
  void Look();

  SlurmStatus Status() const;

 private:
  using Clock = std::chrono::steady_clock;

  absl::Status Steer(const FolderStatus& work);
  absl::Status Judge(const FolderStatus& work, const SlurmQueue& queue, size_t wanted);
  absl::Status Fails(const std::string& why);
  absl::Status Fill(size_t missing);
  absl::Status SubmitArrays(size_t missing);

  const SlurmOptions options_;
  const std::unique_ptr<SlurmTools> tools_;
  const std::function<FolderStatus()> work_;
  const std::function<absl::Status()> ready_;

  // Used only by the thread that looks.
  size_t array_size_;
  bool may_have_workers_ = true;  // of an earlier process
  bool was_empty_ = false;        // there was no lease at the last query
  absl::Status fault_;            // why the workers fail; OK: they work
  // The number of leases taken when workers were submitted. Empty unless none was taken since.
  std::optional<double> trial_;
  // A lower bound of (leases taken + workers in the queue), which only a worker that ended without
  // a lease breaks. Each submission raises it. It is at least (leases taken + waiting workers), so
  // a running worker with many leases hides at most one such end. 0 when no lease waits.
  double submitted_ = 0;
  bool some_ended_ = false;  // without a lease, at the last query that could tell
  size_t step_;
  Clock::time_point next_query_ = {};
  std::chrono::milliseconds backoff_{0};

  mutable Mutex mutex_;
  SlurmStatus status_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<PeriodicThread> looking_;  // last: its thread uses all members above
};

}  // namespace ballpiston::server
