// Machines elsewhere that share a folder with the server. The server's part and the loop of the
// workers are the real ones; the folder is in memory. Workers are killed, crash, stop for minutes,
// are late or end early; operations of the folder fail, its clock jumps, it is emptied, and reports
// that the server has removed are there again.
#pragma once

#include "server/cluster/folder_executor.h"
#include "server/compute/scheduler.h"
#include "server/host.h"
#include "server/worker/worker.h"
#include "tests/server/factory_opener.h"
#include "tests/server/worker/fake_files.h"
#include "tests/simulation/machine.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// Toy experiments. Their blocks take time, and a block that crashes the engine (Question) calls
// `crash`.
ExperimentFactory ToyExperiments(Machine& machine, std::function<void()> crash);

class SimulatedCluster {
 public:
  // The folder outlives the server. `flush` is that of the server's store.
  SimulatedCluster(Machine& machine, Scheduler& scheduler, FakeFiles& files,
                   std::function<absl::Status()> flush, bool engine_crashes);
  ~SimulatedCluster();

  void Start();

 private:
  void Work();
  void WorkOnce();
  EndOfWork EndOfWorker();
  absl::StatusOr<LeaseFile> ReadLease(
      absl::string_view& bytes, std::function<void()> crash = [] {}) const;
  absl::Status BeforeOperation(const std::string& operation, const std::string& path);
  void Trouble();

  Machine& machine_;
  FakeFiles& files_;
  const bool engine_crashes_;
  std::remove_reference_t<decltype(FakeFiles::files)> removed_reports_;
  FolderExecutor executor_;
  bool is_shutting_down_ = false;
  std::vector<Thread> workers_;
};

}  // namespace ballpiston::server
