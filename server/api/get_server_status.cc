#include <map>
#include <string>

#include "server/api/methods.h"
#include "server/api/take_snapshot.h"
#include "server/convert/plan.h"
#include "server/jobs/job_message.h"

namespace ballpiston::server {
namespace {

v1::ServerStatus::State StateOf(const ServerSnapshot& now) {
  if (now.draining) return v1::ServerStatus::DRAINING;
  return now.store_failing ? v1::ServerStatus::STORE_FAILING : v1::ServerStatus::SERVING;
}

v1::SlurmStatus SlurmMessage(const SlurmStatus& slurm) {
  v1::SlurmStatus message;
  message.set_problem(slurm.problem);
  message.set_waiting_tasks(slurm.waiting_tasks);
  message.set_running_tasks(slurm.running_tasks);
  message.set_submitted_tasks(slurm.submitted_tasks);
  message.set_chunks(slurm.chunks);
  message.set_lost_tasks(slurm.lost_tasks);
  message.set_refused_files(slurm.refused_files);
  message.set_queries(slurm.queries);
  return message;
}

v1::ServerStatus StatusMessage(const ServerSnapshot& now) {
  v1::ServerStatus status;
  status.set_state(StateOf(now));
  status.set_version(now.version);
  status.set_engine_version(now.engine_version);
  SetTime(now.start_time, status.mutable_start_time());
  status.set_workers(now.workers);
  status.set_busy_workers(now.busy_workers);
  status.set_queued_jobs(static_cast<double>(now.queued_jobs));
  status.set_running_jobs(static_cast<double>(now.running_jobs + now.cancelling_jobs));
  status.set_streams(static_cast<double>(now.streams));
  status.set_store_bytes(static_cast<double>(now.store_bytes));
  status.set_blocks_computed(now.blocks_computed);
  status.set_samples_computed(now.samples_computed);
  status.set_expiring_jobs(static_cast<double>(now.expiring_jobs));
  status.set_processor_seconds(now.processor_seconds);
  if (now.slurm) *status.mutable_slurm() = SlurmMessage(*now.slurm);
  return status;
}

v1::ServerLimits LimitsMessage(const Limits& limits) {
  v1::ServerLimits message;
  message.set_max_active_jobs(static_cast<double>(limits.max_active_jobs));
  message.set_max_active_jobs_per_principal(
      static_cast<double>(limits.max_active_jobs_per_principal));
  message.set_max_points_per_job(static_cast<double>(limits.max_points_per_job));
  message.set_max_samples_per_job(limits.max_samples_per_job);
  message.set_max_streams(static_cast<double>(limits.max_streams));
  message.set_max_streams_per_principal(static_cast<double>(limits.max_streams_per_principal));
  message.set_max_message_bytes(static_cast<double>(limits.max_message_bytes));
  message.set_max_active_points(static_cast<double>(limits.max_active_points));
  message.set_max_active_points_per_principal(
      static_cast<double>(limits.max_active_points_per_principal));
  message.set_max_calls_per_principal(static_cast<double>(limits.max_calls_per_principal));
  message.set_max_call_bytes_per_principal(
      static_cast<double>(limits.max_call_bytes_per_principal));
  message.set_retain_days(limits.retain_days);
  message.set_max_store_bytes(static_cast<double>(limits.max_store_bytes));
  return message;
}

void AddPrincipals(const ServerSnapshot& now, const std::map<std::string, int64_t>& streams,
                   const Principal& caller, v1::ServerStatus& status) {
  for (const PrincipalSnapshot& of_one : now.principals) {
    status.set_stored_jobs(status.stored_jobs() + static_cast<double>(of_one.stored_jobs));
    if (!caller.MaySee(of_one.principal)) continue;
    v1::PrincipalStatus& principal = *status.add_principals();
    principal.set_principal(of_one.principal);
    principal.set_queued_jobs(static_cast<double>(of_one.queued_jobs));
    principal.set_running_jobs(static_cast<double>(of_one.running_jobs));
    const auto own = streams.find(of_one.principal);
    principal.set_streams(own == streams.end() ? 0 : static_cast<double>(own->second));
    principal.set_stored_jobs(static_cast<double>(of_one.stored_jobs));
    principal.set_stored_bytes(static_cast<double>(of_one.stored_bytes));
  }
}

}  // namespace

absl::StatusOr<v1::ServerStatus> GetServerStatus(ServiceContext& service, const Call& call,
                                                 const v1::GetServerStatusRequest&) {
  const ServerSnapshot now = TakeSnapshot(service);
  v1::ServerStatus status = StatusMessage(now);
  *status.mutable_rates() = RatesMessage(service.ladder.machine().rates);
  *status.mutable_limits() = LimitsMessage(service.limits);
  status.set_principal(call.caller.name);
  status.set_role(RoleName(call.caller.role));
  AddPrincipals(now, service.streams.ByPrincipal(), call.caller, status);
  return status;
}

}  // namespace ballpiston::server
