// One life of the server in the simulated machine: the real store, book, scheduler and threads,
// with toy experiments, on a disk that can fail, and a cluster whose workers fail.
#pragma once

#include "server/book/job_book.h"
#include "server/compute/crash_record.h"
#include "server/compute/scheduler.h"
#include "server/compute/thread_executor.h"
#include "server/periodic_thread.h"
#include "server/store/store.h"
#include "tests/server/factory_opener.h"
#include "tests/simulation/cluster.h"
#include "tests/simulation/machine.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

class Life {
 public:
  // Opens the store on the FaultDisk and resumes its jobs. With a `shared` folder, leases also go
  // to machines that share it. `own_folder` has the record of crashes. `crash`: called in the
  // thread in which the engine crashes; empty: the engine does not crash.
  Life(Machine& machine, FakeFiles* shared, const std::string& own_folder,
       std::function<void()> crash);
  ~Life();  // stops like a server after SIGTERM

  // Not OK: the reason why the server could not start. Then call no other function.
  const absl::Status& status() const { return status_; }
  Store& store() { return *store_; }
  JobBook& book() { return *book_; }
  // The name of this server process in the resume tokens of watches.
  const std::string& name() const { return name_; }

  // From now on clients ignore the answers of this life.
  void Die() { is_over_ = true; }
  bool is_over() const { return is_over_; }

 private:
  absl::Status Start();

  Machine& machine_;
  const std::string name_;
  const std::function<void()> crash_;
  bool is_over_ = false;
  absl::Status status_;
  const std::shared_ptr<CrashRecord> crashes_;
  std::unique_ptr<Store> store_;
  FactoryOpener opener_;
  std::unique_ptr<Scheduler> scheduler_;
  std::unique_ptr<ThreadExecutor> threads_;
  std::unique_ptr<SimulatedCluster> cluster_;
  std::unique_ptr<JobBook> book_;
  std::unique_ptr<PeriodicThread> limits_;
};

}  // namespace ballpiston::server
