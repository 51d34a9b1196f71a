// The machines that share a folder with the server, and what starts workers there.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/cluster/folder_executor.h"
#include "server/cluster/slurm_workers.h"

namespace ballpiston::server {

class Cluster {
 public:
  // Without options of Slurm, somebody else starts the workers. `identity` names the server;
  // `flush` returns OK when all that was reported is on disk. The scheduler must outlive this.
  Cluster(Scheduler& scheduler, ClusterOptions options, const std::optional<SlurmOptions>& slurm,
          const std::string& identity, std::function<absl::Status()> flush);

  void Start();

  struct State {
    std::string problem = {};  // empty: none
    FolderStatus folder;
    SlurmStatus slurm;  // without Slurm: zeros
  };
  State Status() const;

 private:
  FolderExecutor folder_;
  std::unique_ptr<SlurmWorkers> slurm_;  // null without Slurm
};

}  // namespace ballpiston::server
