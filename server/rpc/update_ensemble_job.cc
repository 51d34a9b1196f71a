#include "server/rpc/methods.h"
#include "server/rpc/request_check.h"

namespace ballpiston::server {

absl::StatusOr<v1::EnsembleJob> UpdateEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::UpdateEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("job.name", request.job().name());
  const JobChange change = check.Change(request);
  if (!check.ok()) return check.status();
  return service.book.Update(call.caller, id, change);
}

}  // namespace ballpiston::server
