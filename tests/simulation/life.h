// One life of the server in the simulated machine: the real store, book, scheduler and threads,
// with toy experiments, on a disk that can fail, and a cluster whose workers fail.
#pragma once

#include "server/book/job_book.h"
#include "server/compute/crash_record.h"
#include "server/compute/scheduler.h"
#include "server/compute/thread_executor.h"
#include "server/host.h"
#include "server/periodic_thread.h"
#include "server/store/store.h"
#include "tests/fault/store/fault_disk.h"
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
       std::function<void()> crash)
      : name(absl::StrCat("life", machine.Bits())),
        crash_(std::move(crash)),
        crashes_(std::make_shared<CrashRecord>(own_folder, OutOfMemoryKills())),
        opener_(ToyExperiments(machine, [this] {
          if (!is_over && crash_ != nullptr) crash_();
        })) {
    if (shared != nullptr) {
      cluster_.emplace(
          machine, scheduler_, *shared, [this] { return store_->Flush(); }, crash_ != nullptr);
    }
    status = Start();
  }
  ~Life() {  // stops like a server after SIGTERM
    if (book_) book_->Shutdown();
    limits_.reset();
    threads_.reset();
    cluster_.reset();
    if (store_ != nullptr) store_->Flush().IgnoreError();
    if (store_ != nullptr) store_->Close();
  }

  Store& store() { return *store_; }
  JobBook& book() { return *book_; }

  const std::string name;  // of this server process in the resume tokens of watches
  absl::Status status;     // not OK: why the server could not start; then call no function
  bool is_over = false;    // from now on clients ignore its answers

 private:
  absl::Status Start() {
    // Two readers, so that calls must wait for a free reader.
    auto store = Store::Open(kStorePath, {.readers = 2, .reserve_bytes = size_t{256} << 10});
    if (!store.ok()) return store.status();
    store_ = *std::move(store);
    book_.emplace(*store_, Limits(), scheduler_, crashes_);
    const absl::Status resumed = book_->Resume();
    if (!resumed.ok()) return resumed;
    if (cluster_) cluster_->Start();
    threads_.emplace(scheduler_, kThreads, std::numeric_limits<double>::infinity(), crashes_);
    threads_->Start();
    limits_.emplace(std::chrono::seconds(1), [this] { book_->KeepLimits(WallNow()); });
    return absl::OkStatus();
  }

  static constexpr int kThreads = 2;

  const std::function<void()> crash_;
  const std::shared_ptr<CrashRecord> crashes_;
  std::unique_ptr<Store> store_;
  FactoryOpener opener_;
  Scheduler scheduler_{opener_, kThreads, {.least_seconds_elsewhere = 0}};
  std::optional<ThreadExecutor> threads_;
  std::optional<SimulatedCluster> cluster_;
  std::optional<JobBook> book_;
  std::optional<PeriodicThread> limits_;
};

}  // namespace ballpiston::server
