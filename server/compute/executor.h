// An executor computes leases of the scheduler: threads of this process, or another machine.
//
// An executor takes leases with Scheduler::Next. Of each lease it either reports all chunks, or
// returns the lease (Scheduler::Return), or keeps it until the lease's stop is requested. It may
// report chunks late, twice and in any order.
//
// A local executor (Capacity::local) opens points, takes every lease and shares a lease between
// turns. The scheduler waits for its turns to end before a run ends. Another executor gets leases
// of chunks alone, and only of runs that are worth it.
#pragma once

#include <cstdint>

namespace ballpiston::server {

class Executor {
 public:
  virtual ~Executor() = default;

  // There may be a new lease, or a lease may have been stopped. Called from any thread; must not
  // wait and must not call the scheduler.
  virtual void Wake() = 0;

  // Whether another turn at this lease, which the executor has, would find work. Only local
  // executors are asked, with the scheduler's lock held.
  virtual bool HasTurn(int64_t /*lease*/) const { return false; }

  // Ends all calls of the scheduler. May be called more than once.
  virtual void Shutdown() = 0;
};

}  // namespace ballpiston::server
