// A scheduler with threads that compute, as a server has them.
#pragma once

#include "server/compute/point_opener.h"
#include "server/compute/scheduler.h"
#include "server/compute/thread_executor.h"
#include "tests/server/factory_opener.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

class ThreadPool {
 public:
  ThreadPool(int workers, ExperimentFactory factory)
      : ThreadPool(workers, std::make_unique<FactoryOpener>(std::move(factory))) {}
  ThreadPool(int workers, std::unique_ptr<PointOpener> opener)
      : opener_(std::move(opener)), scheduler_(*opener_, workers), threads_(scheduler_, workers) {
    threads_.Start();
  }

  ~ThreadPool() { Shutdown(); }

  Scheduler& scheduler() { return scheduler_; }
  const ThreadExecutor& threads() const { return threads_; }

  void Add(RunRequest request) { scheduler_.Add(std::move(request)); }
  void Shutdown() { scheduler_.Shutdown(); }

 private:
  const std::unique_ptr<PointOpener> opener_;
  Scheduler scheduler_;
  ThreadExecutor threads_;
};

}  // namespace ballpiston::server
