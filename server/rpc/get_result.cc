#include <utility>

#include "server/rpc/methods.h"
#include "server/rpc/request_check.h"
#include "server/rpc/result_name.h"

namespace ballpiston::server {

absl::StatusOr<v1::PointResult> GetResult(ServiceContext& service, const Call& call,
                                          const v1::GetResultRequest& request) {
  const std::optional<ResultId> id = ResultIdOf(request.name());
  if (!id) {
    return InvalidRequest(
        {{"name", "is not the name of a result: ensembleJobs/{id}/results/{index}"}});
  }
  if (request.unfinished()) {
    auto now = service.book.UnfinishedResult(call.caller, id->job, id->point);
    if (!now.ok()) return now.status();
    if (*now) return Named(**std::move(now), id->job);
  }
  absl::StatusOr<v1::PointResult> result = service.book.Result(call.caller, id->job, id->point);
  if (!result.ok()) return result;
  return Named(*std::move(result), id->job);
}

}  // namespace ballpiston::server
