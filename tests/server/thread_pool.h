// A scheduler with threads that compute, as a server has them.
#pragma once

#include "server/compute/crash_record.h"
#include "server/compute/scheduler.h"
#include "server/compute/thread_executor.h"
#include "tests/server/factory_opener.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

class ThreadPool {
 public:
  ThreadPool(int workers, ExperimentFactory factory,
             std::shared_ptr<CrashRecord> crashes = std::make_shared<CrashRecord>(),
             OrbitDevice* device = nullptr)
      : opener_(std::move(factory)),
        scheduler_(opener_, workers),
        threads_(scheduler_, workers, std::numeric_limits<double>::infinity(), std::move(crashes),
                 device) {
    threads_.Start();
  }

  Scheduler& scheduler() { return scheduler_; }
  const ThreadExecutor& threads() const { return threads_; }

 private:
  FactoryOpener opener_;
  Scheduler scheduler_;
  ThreadExecutor threads_;
};

}  // namespace ballpiston::server
