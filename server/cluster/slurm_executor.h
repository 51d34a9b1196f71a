// Computes leases on a Slurm cluster: job arrays of ballpiston-worker, and files in a shared
// folder.
//
// An array has tasks of one run. A task has leases that take minutes together. The server writes
// the leases into the array's task file and submits the array; a task leaves its chunks in files,
// which the executor reads as they appear and reports. A file with a checksum proves its chunks.
// Slurm says only which tasks wait and run: if a task is gone and has left no final file, the
// missing chunks of its leases go back to the scheduler.
//
// slurmctld, a node, a worker or this server may be killed at any time. No chunk is lost, because a
// chunk that did not arrive is leased again, and task files outlive the server (Scheduler::Adopt).
// No chunk counts twice, because the scheduler takes each once.
//
// If Slurm refuses, or the shared folder cannot be used, the leases go back to the scheduler, for
// the server's threads, and the executor tries again later with one task. Status() has the reason.
// Two threads: one reads files; one runs Slurm's tools, which may block for minutes. Thread-safe.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "absl/functional/function_ref.h"
#include "server/cluster/shared_folder.h"
#include "server/cluster/slurm_tools.h"
#include "server/compute/crash_record.h"
#include "server/compute/scheduler.h"
#include "server/mutex.h"
#include "server/worker/chunk_file.h"

namespace ballpiston::server {

// The work that the server has handed to the cluster, at one moment.
struct SlurmStatus {
  std::string problem;  // empty: none
  double waiting_tasks = 0;
  double running_tasks = 0;
  double submitted_tasks = 0;  // and not seen in the queue yet
  // Since the start.
  double chunks = 0;
  double lost_tasks = 0;
  double refused_files = 0;
  double queries = 0;
};

class SlurmExecutor : public Executor {
 public:
  using Clock = std::chrono::steady_clock;

  // The scheduler must outlive this. `identity` names the server; `flush` returns OK when all that
  // was reported is on disk. Begins with Start.
  SlurmExecutor(Scheduler& scheduler, SlurmOptions options, std::unique_ptr<SlurmTools> tools,
                std::string identity, std::function<absl::Status()> flush,
                std::shared_ptr<CrashRecord> crashes = std::make_shared<CrashRecord>());
  ~SlurmExecutor() override;  // shuts down

  ExecutorTraits traits() const override { return {.local = false}; }
  void Start() override;  // adopts the leases of the arrays of an earlier process
  void Wake() override;
  bool HasTurn(int64_t) const override { return false; }
  void Shutdown() override;  // tasks run on

  SlurmStatus Status() const;

 private:
  enum class Activity { kFiles, kQueue, kSubmission };
  enum class TaskState { kUnknown, kWaiting, kRunning, kOver };

  struct Task {
    std::vector<Lease> leases = {};
    std::set<uint32_t> read_files = {};  // sequence numbers
    TaskState state = TaskState::kUnknown;
    bool left_a_file = false;
    bool has_unread_file = false;  // of a point that is not open yet
    bool is_final = false;         // it has left its last file
    bool is_lost = false;
    std::set<size_t> crashed = {};  // leases at which the engine killed it
    bool unneeded = false;          // Slurm does not have it (any more)
    int missing = 0;                // queries in a row in which it was not in the queue
  };

  struct Array {
    std::vector<Task> tasks = {};
    std::string id = {};  // Slurm's number in the last query
    bool submitted = false;
    Clock::time_point submit_time = {};
  };

  // A cancellation to send to Slurm: some tasks of an array, or the whole array if `id` is empty.
  struct Cancellation {
    std::string name;
    std::string id = {};
    std::set<size_t> tasks = {};
  };

  // ---- files ----
  void CollectUntilStopped();
  std::vector<std::string> ArrayNames() const ABSL_LOCKS_EXCLUDED(mutex_);
  bool HasArray(const std::string& name) const ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status CollectArray(const std::string& name) ABSL_LOCKS_EXCLUDED(collect_mutex_, mutex_);
  bool IsNew(const std::string& array, const ChunkFileName& file);
  void TakeFile(const std::string& array, const ChunkFileName& name);
  absl::Status CheckFile(const std::string& array, const ChunkFile& file,
                         const std::vector<Lease>& leases) const;
  absl::Status ReportFile(const ChunkFile& file, const std::vector<Lease>& leases);
  void NoteUnread(const std::string& array, const ChunkFileName& name);
  void NoteFile(const std::string& array, const ChunkFileName& name,
                const absl::StatusOr<ChunkFile>& file, const absl::Status& taken);

  // ---- what an earlier process left ----
  bool Recover();  // false: the folder cannot be used now
  void RecoverArray(const std::string& name);
  Task RecoveredTask(const std::vector<IdentifiedLease>& leases);

  // ---- Slurm ----
  void SteerUntilStopped();
  void Steer();
  void Guarded(Activity activity, absl::FunctionRef<absl::Status()> round);
  void NoteCrashes(const std::string& name, size_t index, Task& task)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void EndTasks(const std::function<bool(const Task&)>& has_ended, bool tried)
      ABSL_LOCKS_EXCLUDED(mutex_);
  void EndFinalTasks();
  void EndUnneededTasks();
  void EndArray(const std::string& name) ABSL_LOCKS_EXCLUDED(mutex_);
  bool IsNeeded(const Task& task) const;
  std::optional<Cancellation> CancellationOf(const std::string& name, const Array& array) const;
  void DropUnneededTasks();
  void Cancel(const Cancellation& cancellation);
  void QueryIfDue();
  void NoteQueue(const std::map<std::string, QueuedArray>& queue, Clock::time_point asked);
  void NoteTasks(const std::string& name, const QueuedArray* queued, Clock::time_point asked);
  void EndLostTasks(const std::string& name);
  void GiveUpWaiting(const std::string& name, const std::string& reason);
  void BackOff(const absl::Status& problem) ABSL_LOCKS_EXCLUDED(mutex_);

  // ---- submission ----
  void SubmitNew();
  size_t RoomForTasks() const ABSL_LOCKS_EXCLUDED(mutex_);
  void ReturnGathered();
  absl::StatusOr<std::string> PreparedWorker() const;
  bool Gather(double seconds);
  void SubmitRun(const std::string& worker, std::vector<Lease> leases);
  void SubmitArray(const std::string& worker, std::vector<std::vector<Lease>> tasks);
  absl::Status WriteArray(const std::string& name,
                          const std::vector<std::vector<Lease>>& tasks) const;
  void NoteSubmission(const std::string& name, const absl::Status& submitted);
  void ReturnUntried(const std::vector<std::vector<Lease>>& tasks);
  void RemoveEnded();

  Task* FindTask(const std::string& array, size_t task) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  size_t TasksInFlight() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  bool AwaitNextLook();  // false: stopped
  void NoteOutcome(Activity activity, const absl::Status& outcome) ABSL_LOCKS_EXCLUDED(mutex_);
  std::string NewName();
  JobIdentity IdentityOf(const Lease& lease) const;

  Scheduler& scheduler_;
  const SlurmOptions options_;
  const std::unique_ptr<SlurmTools> tools_;
  const std::string identity_;
  const std::string prefix_;  // of the names of this server's arrays
  const std::function<absl::Status()> flush_;
  const std::shared_ptr<CrashRecord> crashes_;
  const SharedFolder folder_;
  Capacity capacity_;

  Mutex collect_mutex_ ABSL_ACQUIRED_BEFORE(mutex_);  // held during all of CollectArray
  mutable Mutex mutex_;  // never held during a call of the scheduler, except Needs
  Condition changed_;
  std::stop_source stop_;
  std::map<std::string, Array> arrays_ ABSL_GUARDED_BY(mutex_);  // by name
  SlurmStatus counts_ ABSL_GUARDED_BY(mutex_);
  // Bytes that a task may use: the least of those whose leases needed more.
  double node_memory_ ABSL_GUARDED_BY(mutex_) = std::numeric_limits<double>::infinity();
  // By activity; empty: its last attempt succeeded.
  std::array<std::string, 3> problems_ ABSL_GUARDED_BY(mutex_);
  Clock::time_point last_query_ ABSL_GUARDED_BY(mutex_);
  Clock::time_point next_submission_ ABSL_GUARDED_BY(mutex_);
  // 0: nothing has failed since a task left a file.
  std::chrono::milliseconds backoff_ ABSL_GUARDED_BY(mutex_){0};

  // Used only by the thread that runs Slurm's tools.
  bool recovered_ = false;
  std::map<int64_t, std::vector<Lease>> gathered_;  // by run: not submitted yet
  int looks_at_gathered_ = 0;
  size_t array_size_;

  std::thread collector_;
  std::thread steerer_;
};

}  // namespace ballpiston::server
