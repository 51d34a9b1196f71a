#include "server/api/methods.h"
#include "server/api/request_check.h"
#include "server/observability/log.h"

namespace ballpiston::server {

absl::StatusOr<google::protobuf::Empty> DeleteEnsembleJob(
    ServiceContext& service, const Call& call, const v1::DeleteEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  if (!check.ok()) return check.status();
  const absl::Status deleted = service.book.Delete(call.caller, id);
  if (!deleted.ok()) return deleted;
  Log(Severity::kInfo, "job deleted",
      {{"method", call.method},
       {"job", request.name()},
       {"principal", call.caller.name},
       {"request_id", call.request_id}});
  return google::protobuf::Empty();
}

}  // namespace ballpiston::server
