// The threads of this process that compute leases.
//
// The threads share a lease: each computes blocks of its chunks in a session of its own. Before
// every turn a thread asks the scheduler for the lease whose turn it is.
// An exception from a block ends only the block's run, with a failure. Thread-safe.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "server/compute/crash_record.h"
#include "server/compute/scheduler.h"
#include "server/host.h"
#include "server/mutex.h"

namespace ballpiston::server {

class ThreadExecutor : public Executor {
 public:
  // The scheduler must outlive this. `seconds` bounds a lease (Capacity), so that something is left
  // for other executors. The record always has the runs that are being computed. `device`, which
  // must outlive this and may be null, computes flights for the threads.
  ThreadExecutor(Scheduler& scheduler, int threads,
                 double seconds = std::numeric_limits<double>::infinity(),
                 std::shared_ptr<CrashRecord> crashes = std::make_shared<CrashRecord>(),
                 OrbitDevice* device = nullptr);
  ~ThreadExecutor() override;  // shuts down

  // Begins to take leases. Call it once, after the runs of an earlier process were added.
  void Start();
  void Wake() override ABSL_LOCKS_EXCLUDED(mutex_);
  bool HasTurn(int64_t lease) const override;
  void Shutdown() override;

  // These take no lock.
  int workers() const { return workers_; }
  int busy() const { return busy_.load(std::memory_order_relaxed); }           // that compute now
  uint64_t blocks() const { return blocks_.load(std::memory_order_relaxed); }  // since the start

 private:
  class SharedLease;
  using SharedPointer = std::shared_ptr<SharedLease>;

  void Work();
  std::optional<Lease> AwaitLease();
  void TakeTurn(const Lease& lease) ABSL_LOCKS_EXCLUDED(mutex_);
  void Compute(const Lease& lease) ABSL_LOCKS_EXCLUDED(mutex_);
  SharedPointer Find(const Lease& lease) ABSL_LOCKS_EXCLUDED(mutex_);
  void DropStopped() ABSL_LOCKS_EXCLUDED(mutex_);

  Scheduler& scheduler_;
  const int workers_;
  const std::shared_ptr<CrashRecord> crashes_;
  OrbitDevice* const device_;
  Capacity capacity_;
  std::atomic<int> busy_ = 0;
  std::atomic<uint64_t> blocks_ = 0;

  mutable Mutex mutex_;
  Condition woken_;
  uint64_t wakes_ ABSL_GUARDED_BY(mutex_) = 0;
  bool shutting_down_ ABSL_GUARDED_BY(mutex_) = false;
  std::map<int64_t, SharedPointer> leases_ ABSL_GUARDED_BY(mutex_);  // by number
  std::vector<Thread> threads_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
