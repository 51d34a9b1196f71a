// Decides which lease an executor gets next, and merges what executors report.
//
// The scheduler is passive: it has no threads and no clock. Executors (executor.h) call it. A lease
// goes to the run whose turn it is (fair_share.h; each executor has its own shares), or to the next
// run if that run has no lease for this executor now. The scheduler merges chunks in order under
// its lock, so results depend neither on executors nor on the order of reports. Properties, each
// with a test of its name:
//   1. APilotIsComputedOnceForAllRuns.
//   2. AStoppedRunEndsWhenItsTurnsHaveEnded.
//   3. TheLeasesOfThisServerTakeNoMoreMemoryThanTheLimit.
//   4. ALargePointGetsItsTurn (held_leases.h).
//   5. SuspectsAreComputedAloneOneAfterTheOther. A suspect is a run that was being computed at two
//      deaths of the process (crash_record.h): other runs pause, and executors elsewhere too. It
//      has one lease of one chunk at a time, so it holds no memory when it pauses.
// Thread-safe.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "server/compute/executor.h"
#include "server/compute/fair_share.h"
#include "server/compute/held_leases.h"
#include "server/compute/lease.h"
#include "server/compute/point_opener.h"
#include "server/compute/run.h"
#include "server/mutex.h"

namespace ballpiston::server {

class Scheduler {
 public:
  // The opener must outlive this. `workers`: the threads of local executors, for budgets and
  // checkpoints.
  Scheduler(PointOpener& opener, int workers, SchedulerOptions options = {});

  // Before the first lease. Returns the executor's number.
  size_t AddExecutor(Executor& executor);
  // The scheduler calls the executor no more. After the executor's Shutdown, in its destructor.
  void RemoveExecutor(size_t executor);

  void Add(RunRequest request);

  // The next turn is given by the new priority. Leases that executors hold go on.
  void SetPriority(int64_t run, int32_t priority);

  // The run's journal then receives Ended with this status, unless the run is over already.
  void Stop(int64_t run, absl::Status why) ABSL_LOCKS_EXCLUDED(mutex_);
  void Cancel(int64_t run) { Stop(run, absl::CancelledError("the job was cancelled")); }

  // Gives no more leases, requests the stop of all, shuts the executors down, and writes the
  // checkpoints of unfinished points, so that a later process can resume them. May be called more
  // than once.
  void Shutdown();

  // ---- for executors ----

  // The lease to work on now; empty if there is none. For a local executor it may be a lease that
  // the executor has already (Executor::HasTurn). A turn at the lease begins. May wait for the
  // disk.
  std::optional<Lease> Next(const Capacity& capacity);

  // Opens one of the points that the lease asks to open. May take long.
  void Open(const Lease& lease, size_t point);

  // Chunks that nobody needs are dropped. An executor that is not local may also report chunks of
  // a lease that it does not have, or that an earlier process of this server gave; `run`,
  // `generation`, `point` and `executor` of the lease are used. Errors, of such executors:
  //   DATA_LOSS    a chunk does not belong to its point; the others are merged
  //   UNAVAILABLE  the point is not open yet, or the run is paused: report again later
  // Of such an executor, returns when the disk has room for more reports.
  absl::Status Report(const Lease& lease, LeaseReport report);

  // For a local executor: a turn at the lease ends, after its last report. `seconds`: processor
  // time of the whole turn. False if the executor needs the lease no more. May wait for the disk.
  bool EndTurn(const Lease& lease, double seconds);

  // These are for executors that are not local.

  // The executor ends with the lease. Chunks that were not reported go out again, as another
  // attempt if the executor `tried` to compute them. May wait for the disk.
  void Return(const Lease& lease, bool tried = true);

  // The same after an attempt whose process crashed. After kMostDeaths crashes of the lease the run
  // fails with ENGINE_CRASHED.
  void ReturnCrashed(Lease lease);

  // Whether chunks of the lease may still be needed.
  bool Needs(const Lease& lease) const;

  // ---- for watches ----

  // Copies of the run's unfinished points, those that changed last first, at most `limit`.
  std::vector<LivePoint> NewestPoints(int64_t run, size_t limit) const;

  // A copy of an unfinished point, if some of it is computed.
  std::optional<LivePoint> Unfinished(int64_t run, size_t index) const;

  // Totals since the scheduler was made: the samples that were merged, and the processor time of
  // what was computed. They take no lock.
  double samples() const { return samples_.load(std::memory_order_relaxed); }
  double processor_seconds() const { return processor_seconds_.load(std::memory_order_relaxed); }

 private:
  struct Member {        // an executor
    Executor* executor;  // null: removed
    FairShare shares;
  };

  using RunPointer = std::shared_ptr<Run>;

  RunPointer FindRun(int64_t key) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // For a new lease of a local executor.
  Capacity WithBounds(const Capacity& capacity, const Run& run) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::optional<Lease> Choose(const Capacity& capacity) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::optional<Lease> NextOf(Run& run, const Capacity& capacity)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void StopRun(Run& run, absl::Status why) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void EndPilot(const Run& owner, const PilotPlace& place) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Charge(Run& run, const Lease& lease, double seconds) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Leases whose stop was requested and at which no local turn is in progress.
  void DropStoppedLeases(const Run& run) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  absl::Status OpenOne(Run& run, size_t index) ABSL_LOCKS_EXCLUDED(mutex_);
  LeaseMemory MemoryOf(const Run& run, size_t index);
  absl::Status AwaitPilot(Run& run, size_t index, const PilotPlace& place)
      ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status Resume(Run& run, size_t index, OpenPoint& open);
  void FinishPoint(const RunPointer& run, const Lease& lease) ABSL_LOCKS_EXCLUDED(mutex_);
  void Conclude(const RunPointer& run) ABSL_LOCKS_EXCLUDED(mutex_);
  bool IsPaused(const Run& run) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool MayTakeTurn(const Run& run, bool is_local) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void ClearIfRefuted(const RunPointer& run) ABSL_LOCKS_EXCLUDED(mutex_);
  void EndPilotsOf(const Run& run) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::vector<Executor*> Executors() const ABSL_LOCKS_EXCLUDED(mutex_);
  void WakeExecutors() ABSL_LOCKS_EXCLUDED(mutex_);

  PointOpener& opener_;
  const int workers_;
  const SchedulerOptions options_;
  std::atomic<double> samples_ = 0;
  std::atomic<double> processor_seconds_ = 0;

  mutable Mutex mutex_;
  bool shutting_down_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<Member> executors_ ABSL_GUARDED_BY(mutex_);
  std::map<int64_t, RunPointer> runs_ ABSL_GUARDED_BY(mutex_);
  std::deque<int64_t> suspects_ ABSL_GUARDED_BY(mutex_);  // the first is computed alone
  HeldLeases held_ ABSL_GUARDED_BY(mutex_);
  std::map<PilotPlace, int64_t> pilots_ ABSL_GUARDED_BY(mutex_);  // in progress, and by which run
};

}  // namespace ballpiston::server
