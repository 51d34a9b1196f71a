// Decides which lease an executor gets next, and merges what executors report.
//
// The scheduler is passive: it has no threads and no timer. Executors (lease.h) call it. A lease
// goes to the run whose turn it is (fair_share.h; the shares of this server's threads and those of
// executors elsewhere are separate), or to the next run if that run has no lease for this executor
// now. The scheduler merges chunks in order under its lock, so results depend neither on executors
// nor on the order of reports.
// Properties, each with a test of its name:
//   1. AStoppedRunEndsWhenItsTurnsHaveEnded.
//   2. TheLeasesOfThisServerTakeNoMoreMemoryThanTheLimit.
//   3. ALargePointGetsItsTurn (held_leases.h).
//   4. SuspectsAreComputedAloneOneAfterTheOther. A suspect is a run that was being computed at two
//      deaths of the process (crash_record.h): other runs pause, and executors elsewhere too. It
//      has one lease of one chunk at a time, so it holds no memory when it pauses.
//   5. APrincipalLeavesMemoryToTheOthers (held_leases.h).
//   6. TheOthersGoOnAfterTwoMinutes of a suspect.
// Thread-safe.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/status.h"
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

  void Add(RunRequest request);

  // The next turn is given by the new priority. Leases that executors hold go on.
  void SetPriority(int64_t run, int32_t priority);

  // The run's journal then receives Ended with this status, unless the run is over already.
  void Stop(int64_t run, absl::Status why) ABSL_LOCKS_EXCLUDED(mutex_);
  void Cancel(int64_t run) { Stop(run, absl::CancelledError("the job was cancelled")); }

  // Gives no more leases, requests the stop of all, waits for the turns in progress, and writes the
  // checkpoints of unfinished points, so that a later process can resume them. Executors elsewhere
  // keep what they have for that process. May be called more than once.
  void Shutdown() ABSL_LOCKS_EXCLUDED(mutex_);

  // ---- for executors ----

  // The lease to work on now; empty if there is none, or after Shutdown. For a local executor it
  // may be a lease that the executor already has (SharedWork::HasTurn). A turn at the lease begins.
  // May wait for the disk.
  std::optional<Lease> Next(const Capacity& capacity);

  // There may be a new lease, or a turn at one. Call it after a report.
  void Wake() { woken_.NotifyAll(); }

  // Opens one of the points that the lease asks to open. May take long; while the disk cannot be
  // read, it tries again until the run is stopped.
  void Open(const Lease& lease, size_t point);

  // Chunks that nobody needs are dropped. An executor that is not local may also report chunks of
  // a lease that it does not have, or that an earlier process of this server gave; `run`,
  // `generation`, `point` and `local` of the lease are used. Errors, of such executors:
  //   DATA_LOSS    a chunk does not belong to its point; the others are merged
  //   UNAVAILABLE  the point is not computed now: report again later
  // Of such an executor, returns when the disk has room for more reports.
  absl::Status Report(const Lease& lease, LeaseReport report);

  // For a local executor: a turn at the lease ends, after its last report. `seconds`: processor
  // time of the whole turn. Waits for the disk if a point was opened or finished, which counts as
  // time of the run: other runs with fewer results have the threads meanwhile.
  void EndTurn(const Lease& lease, double seconds);

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
  using RunPointer = std::shared_ptr<Run>;

  RunPointer FindRun(int64_t key) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // For a new lease of a local executor.
  Capacity WithBounds(const Capacity& capacity, const Run& run) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::optional<Lease> Choose(const Capacity& capacity) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::optional<Lease> NextOf(Run& run, const Capacity& capacity)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // StopRun also stops the run. Both return leases whose work is to be destroyed without the
  // lock: their stop was requested, and no local turn at them is in progress.
  std::vector<Lease> DropStoppedLeases(const Run& run) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::vector<Lease> StopRun(Run& run, absl::Status why) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Charge(Run& run, const Lease& lease, double seconds) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  absl::Status OpenOne(Run& run, size_t index) ABSL_LOCKS_EXCLUDED(mutex_);
  LeaseMemory MemoryOf(const Run& run, size_t index);
  absl::Status Resume(Run& run, size_t index, OpenPoint& open);
  void FinishPoint(const RunPointer& run, const Lease& lease) ABSL_LOCKS_EXCLUDED(mutex_);
  void Conclude(const RunPointer& run) ABSL_LOCKS_EXCLUDED(mutex_);
  bool HasTurns() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool IsPaused(const Run& run) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool MayTakeTurn(const Run& run, bool is_local) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void EndSuspicionIfDue(const RunPointer& run) ABSL_LOCKS_EXCLUDED(mutex_);
  FairShare& SharesOf(const Lease& lease) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return shares_[lease.local];
  }

  PointOpener& opener_;
  const int workers_;
  const SchedulerOptions options_;
  std::atomic<double> samples_ = 0;
  std::atomic<double> processor_seconds_ = 0;

  mutable Mutex mutex_;
  Condition woken_;  // there may be a lease, or a turn has ended
  bool shutting_down_ ABSL_GUARDED_BY(mutex_) = false;
  std::array<FairShare, 2> shares_ ABSL_GUARDED_BY(mutex_);  // elsewhere and here
  std::map<int64_t, RunPointer> runs_ ABSL_GUARDED_BY(mutex_);
  std::deque<int64_t> suspects_ ABSL_GUARDED_BY(mutex_);  // the first is computed alone
  HeldLeases held_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
