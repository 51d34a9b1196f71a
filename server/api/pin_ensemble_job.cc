#include "server/api/methods.h"
#include "server/api/request_check.h"

namespace ballpiston::server {

absl::StatusOr<v1::EnsembleJob> PinEnsembleJob(ServiceContext& service, const Call& call,
                                               const v1::PinEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  if (!check.ok()) return check.status();
  return service.book.Update(call.caller, id, {.pinned = request.pinned()});
}

}  // namespace ballpiston::server
