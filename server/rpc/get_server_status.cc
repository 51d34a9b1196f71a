#include <map>
#include <string>
#include <utility>

#include "absl/time/clock.h"
#include "core/engine_version.h"
#include "server/convert/timestamp.h"
#include "server/rpc/methods.h"
#include "server/rpc/server_status.h"
#include "server/store/data_directory.h"
#include "server/version.h"

namespace ballpiston::server {
namespace {

bool StoreFails(const Store& store) { return store.failing() || store.stalled(); }

v1::ClusterStatus ClusterMessage(const Cluster::State& cluster) {
  v1::ClusterStatus message;
  message.set_problem(cluster.problem);
  message.set_waiting_leases(cluster.folder.waiting_leases);
  message.set_taken_leases(cluster.folder.taken_leases);
  message.set_waiting_workers(static_cast<double>(cluster.slurm.queue.waiting));
  message.set_running_workers(static_cast<double>(cluster.slurm.queue.running));
  message.set_chunks(cluster.folder.chunks);
  message.set_lost_leases(cluster.folder.lost_leases);
  message.set_refused_files(cluster.folder.refused_files);
  message.set_queries(cluster.slurm.queries);
  return message;
}

void AddWork(const ServiceContext& service, v1::ServerStatus& status) {
  status.set_workers(service.threads.workers());
  status.set_busy_workers(service.threads.busy());
  status.set_blocks_computed(static_cast<double>(service.threads.blocks()));
  status.set_samples_computed(service.scheduler.samples());
  status.set_processor_seconds(service.scheduler.processor_seconds());
  if (service.cluster == nullptr) return;
  *status.mutable_cluster() = ClusterMessage(service.cluster->Status());
}

// Sets the numbers of each principal that the viewer may see, and the totals of all principals.
void AddPrincipals(const ServiceContext& service, const Principal& viewer,
                   v1::ServerStatus& status) {
  std::map<std::string, int64_t> streams = service.quotas.streams.ByPrincipal();
  for (v1::PrincipalStatus& principal : service.book.JobsByPrincipal()) {
    principal.set_streams(static_cast<double>(streams[principal.principal()]));
    status.set_queued_jobs(status.queued_jobs() + principal.queued_jobs());
    status.set_running_jobs(status.running_jobs() + principal.running_jobs());
    status.set_stored_jobs(status.stored_jobs() + principal.stored_jobs());
    if (viewer.MaySee(principal.principal())) *status.add_principals() = std::move(principal);
  }
}

v1::ServerLimits LimitsMessage(const Limits& limits) {
  v1::ServerLimits message;
  message.set_max_points_per_job(static_cast<double>(limits.max_points_per_job));
  message.set_max_active_jobs_per_principal(
      static_cast<double>(limits.max_active_jobs_per_principal));
  message.set_max_active_points_per_principal(
      static_cast<double>(limits.max_active_points_per_principal));
  message.set_max_streams_per_principal(static_cast<double>(limits.max_streams_per_principal));
  message.set_retain_days(limits.retain_days);
  return message;
}

}  // namespace

v1::ServerStatus StatusOf(const ServiceContext& service, const Principal& viewer) {
  v1::ServerStatus status;
  status.set_state(service.draining            ? v1::ServerStatus::DRAINING
                   : StoreFails(service.store) ? v1::ServerStatus::STORE_FAILING
                                               : v1::ServerStatus::SERVING);
  status.set_version(kVersion);
  status.set_engine_version(EngineVersion());
  SetTime(service.start_time, status.mutable_start_time());
  status.set_streams(static_cast<double>(service.quotas.streams.taken()));
  status.set_store_bytes(static_cast<double>(StoreBytes(service.store_path)));
  status.set_expiring_jobs(static_cast<double>(service.book.CountExpiring(absl::Now())));
  AddWork(service, status);
  AddPrincipals(service, viewer, status);
  return status;
}

absl::StatusOr<v1::ServerStatus> GetServerStatus(ServiceContext& service, const Call& call,
                                                 const v1::GetServerStatusRequest&) {
  v1::ServerStatus status = StatusOf(service, call.caller);
  const MachineRates& rates = service.ladder.machine().rates;
  status.mutable_rates()->set_jump(rates.jump);
  status.mutable_rates()->set_wall_hit(rates.lanes.wall_hit);
  *status.mutable_limits() = LimitsMessage(service.limits);
  status.set_principal(call.caller.name);
  status.set_role(RoleName(call.caller.role));
  return status;
}

}  // namespace ballpiston::server
