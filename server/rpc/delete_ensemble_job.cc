#include "server/rpc/methods.h"
#include "server/rpc/request_check.h"

namespace ballpiston::server {

absl::StatusOr<google::protobuf::Empty> DeleteEnsembleJob(
    ServiceContext& service, const Call& call, const v1::DeleteEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  if (!check.ok()) return check.status();
  const absl::Status deleted = service.book.Delete(call.caller, id);
  if (!deleted.ok()) return deleted;
  LogDone(call, "job deleted", request.name());
  return google::protobuf::Empty();
}

}  // namespace ballpiston::server
