#include "server/cluster/cluster.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/cluster/cluster_folder.h"

namespace ballpiston::server {
namespace {

// Slurm starts as many workers as there are leases, so all of these are laid.
ClusterOptions WithSlurm(ClusterOptions options, const SlurmOptions& slurm) {
  options.most_leases = options.least_waiting = slurm.workers;
  options.longest_chunk = LongestChunk(slurm);
  return options;
}

}  // namespace

Cluster::Cluster(Scheduler& scheduler, ClusterOptions options,
                 const std::optional<SlurmOptions>& slurm, const std::string& identity,
                 std::function<absl::Status()> flush)
    : folder_(scheduler, slurm ? WithSlurm(options, *slurm) : options,
              std::make_unique<FolderFiles>(options.folder),
              {.identity = identity,
               .flush = std::move(flush),
               .prepare = [folder = options.folder, identity] {
                 return PrepareFolder(folder, identity);
               }}) {
  if (!slurm) return;
  auto tools = std::make_unique<SlurmTools>(*slurm, "bp-" + identity, options.folder);
  slurm_ = std::make_unique<SlurmWorkers>(
      *slurm, std::move(tools), [this] { return folder_.Status(); },
      [options, identity] {
        const absl::Status prepared = PrepareFolder(options.folder, identity);
        return prepared.ok() ? CopyWorker(options.folder, options.worker) : prepared;
      });
}

void Cluster::Start() {
  folder_.Start();
  if (slurm_ != nullptr) slurm_->Start();
}

Cluster::State Cluster::Status() const {
  State state = {.problem = {}, .folder = folder_.Status(), .slurm = {}};
  if (slurm_ != nullptr) state.slurm = slurm_->Status();
  const std::string &folder = state.folder.problem, &slurm = state.slurm.problem;
  state.problem = absl::StrCat(folder, folder.empty() || slurm.empty() ? "" : "; ", slurm);
  return state;
}

}  // namespace ballpiston::server
