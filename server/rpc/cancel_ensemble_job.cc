#include "server/rpc/methods.h"
#include "server/rpc/request_check.h"

namespace ballpiston::server {

absl::StatusOr<v1::EnsembleJob> CancelEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::CancelEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  const std::string request_id = check.RequestId(request.request_id());
  if (!check.ok()) return check.status();
  absl::StatusOr<v1::EnsembleJob> job = service.book.Cancel(call.caller, id, request_id);
  if (job.ok()) LogDone(call, "job cancelled on request", job->name());
  return job;
}

}  // namespace ballpiston::server
