#include "server/api/methods.h"
#include "server/api/request_check.h"
#include "server/observability/log.h"

namespace ballpiston::server {

absl::StatusOr<v1::EnsembleJob> CancelEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::CancelEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  const std::string request_id = check.RequestId(request.request_id());
  if (!check.ok()) return check.status();
  absl::StatusOr<v1::EnsembleJob> job = service.book.Cancel(call.caller, id, request_id);
  if (job.ok()) {
    Log(Severity::kInfo, "job cancelled on request",
        {{"method", call.method},
         {"job", job->name()},
         {"principal", call.caller.name},
         {"request_id", call.request_id}});
  }
  return job;
}

}  // namespace ballpiston::server
