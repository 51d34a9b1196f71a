#include "server/rpc/methods.h"
#include "server/rpc/request_check.h"

namespace ballpiston::server {

absl::StatusOr<v1::EnsembleJob> GetEnsembleJob(ServiceContext& service, const Call& call,
                                               const v1::GetEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  if (!check.ok()) return check.status();
  return service.book.Get(call.caller, id);
}

}  // namespace ballpiston::server
