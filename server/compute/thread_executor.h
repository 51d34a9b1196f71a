// The threads of this process that compute leases: the local executor (lease.h).
//
// The threads share a lease: each computes blocks of its chunks in a session of its own. Before
// every turn a thread asks the scheduler for the lease whose turn it is, and waits there for one.
// An exception from a block ends only the block's run, with a failure. Thread-safe.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "server/compute/crash_record.h"
#include "server/compute/scheduler.h"
#include "server/host.h"

namespace ballpiston::server {

class ThreadExecutor {
 public:
  // The scheduler must outlive this. `seconds` bounds a lease (Capacity), so that something is left
  // for other executors. The record always has the runs that are being computed. `device`, which
  // must outlive this and may be null, computes flights for the threads.
  ThreadExecutor(Scheduler& scheduler, int threads,
                 double seconds = std::numeric_limits<double>::infinity(),
                 std::shared_ptr<CrashRecord> crashes = std::make_shared<CrashRecord>(),
                 OrbitDevice* device = nullptr);
  ~ThreadExecutor();  // shuts the scheduler down, and waits for the threads

  // Begins to take leases. Call it once, after the runs of an earlier process were added.
  void Start();

  // These take no lock.
  int workers() const { return workers_; }
  int busy() const { return busy_.load(std::memory_order_relaxed); }           // that compute now
  uint64_t blocks() const { return blocks_.load(std::memory_order_relaxed); }  // since the start

 private:
  class SharedLease;

  void Work();
  void TakeTurn(const Lease& lease);
  void Compute(const Lease& lease, std::optional<CrashRecord::Entry>& computing);

  Scheduler& scheduler_;
  const int workers_;
  const std::shared_ptr<CrashRecord> crashes_;
  OrbitDevice* const device_;
  const Capacity capacity_;
  std::atomic<int> busy_ = 0;
  std::atomic<uint64_t> blocks_ = 0;
  std::vector<Thread> threads_;
};

}  // namespace ballpiston::server
