// Machines elsewhere that share a folder with the server. The server's part and the loop of the
// workers are the real ones; the folder is in memory. Workers are killed, stop for minutes, are
// late or end early; operations of the folder fail, its clock jumps, and it is emptied.
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

class SimulatedCluster {
 public:
  // The folder outlives the server. `flush` is that of the server's store.
  SimulatedCluster(Machine& machine, Scheduler& scheduler, FakeFiles& files,
                   ExperimentFactory experiments, std::function<absl::Status()> flush);
  ~SimulatedCluster();

  void Start();

 private:
  void Work();
  void WorkOnce();
  EndOfWork EndOfWorker();
  absl::StatusOr<LeaseFile> ReadLease(absl::string_view& bytes) const;
  void Trouble();

  Machine& machine_;
  FakeFiles& files_;
  const ExperimentFactory experiments_;
  FolderExecutor executor_;
  bool is_shutting_down_ = false;
  std::vector<Thread> workers_;
};

}  // namespace ballpiston::server
