// The details of an error beside its code and message.
//
//   EXPECT_THAT(server.Delete(name), IsError(grpc::StatusCode::NOT_FOUND, "JOB_NOT_FOUND"));
#pragma once

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/convert/errors.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

struct ErrorDetails {
  std::string reason;  // this and the next two are from google.rpc.ErrorInfo
  std::string domain;
  std::map<std::string, std::string> metadata;
  std::vector<std::string> fields;  // the fields of the violations in google.rpc.BadRequest
  int64_t retry_seconds = 0;        // from google.rpc.RetryInfo
};

inline ErrorDetails DetailsOf(const grpc::Status& status) {
  ErrorDetails details;
  google::rpc::Status rpc;
  rpc.ParseFromString(status.error_details());
  for (const auto& any : rpc.details()) {
    google::rpc::ErrorInfo info;
    google::rpc::BadRequest request;
    google::rpc::RetryInfo retry;
    if (any.UnpackTo(&info)) {
      details.reason = info.reason();
      details.domain = info.domain();
      details.metadata.insert(info.metadata().begin(), info.metadata().end());
    }
    if (any.UnpackTo(&retry)) details.retry_seconds = retry.retry_delay().seconds();
    if (!any.UnpackTo(&request)) continue;
    for (const auto& violation : request.field_violations()) {
      details.fields.push_back(violation.field());
    }
  }
  return details;
}
inline ErrorDetails DetailsOf(const absl::Status& status) { return DetailsOf(GrpcStatus(status)); }

template <typename Result>
std::string ReasonOf(const Result& result) {
  if constexpr (requires { result.error_code(); }) {
    return DetailsOf(result).reason;
  } else {
    return DetailsOf(StatusOf(result)).reason;
  }
}

MATCHER_P2(IsError, code, reason, "") {
  *result_listener << "whose reason is " << ReasonOf(arg) << ", ";
  return testing::ExplainMatchResult(StatusIs(code), arg, result_listener) &&
         ReasonOf(arg) == reason;
}

}  // namespace ballpiston::server
