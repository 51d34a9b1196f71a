#include "tests/server/error_details.h"

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/convert/errors.h"

namespace ballpiston::server {

ErrorDetails DetailsOf(const grpc::Status& status) {
  ErrorDetails details;
  google::rpc::Status rpc;
  rpc.ParseFromString(status.error_details());
  for (const auto& any : rpc.details()) {
    google::rpc::ErrorInfo info;
    google::rpc::BadRequest request;
    if (any.UnpackTo(&info)) {
      details.reason = info.reason();
      details.domain = info.domain();
      details.metadata.insert(info.metadata().begin(), info.metadata().end());
    }
    if (!any.UnpackTo(&request)) continue;
    for (const auto& violation : request.field_violations()) {
      details.fields.push_back(violation.field());
    }
  }
  return details;
}

ErrorDetails DetailsOf(const absl::Status& status) { return DetailsOf(GrpcStatus(status)); }

}  // namespace ballpiston::server
