// The details of an error beside its code and message. An error is an absl::Status, an
// absl::StatusOr or a grpc::Status.
//
//   EXPECT_THAT(server.Delete(name), IsError(grpc::StatusCode::NOT_FOUND, "JOB_NOT_FOUND"));
#pragma once

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/convert/errors.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// Empty if the error does not have this detail.
template <typename Detail, typename Result>
Detail DetailOf(const Result& result) {
  google::rpc::Status error;
  if constexpr (requires { result.error_details(); }) {
    error.ParseFromString(result.error_details());
  } else {
    error = RpcStatus(StatusOf(result));
  }
  Detail detail;
  for (const auto& any : error.details()) {
    if (any.UnpackTo(&detail)) break;
  }
  return detail;
}

template <typename Result>
std::string ReasonOf(const Result& result) {
  return DetailOf<google::rpc::ErrorInfo>(result).reason();
}

template <typename Result>
auto MetadataOf(const Result& result) {
  return DetailOf<google::rpc::ErrorInfo>(result).metadata();
}

// The fields that a request gives wrongly.
template <typename Result>
std::vector<std::string> FieldsOf(const Result& result) {
  std::vector<std::string> fields;
  const auto request = DetailOf<google::rpc::BadRequest>(result);
  for (const auto& violation : request.field_violations()) fields.push_back(violation.field());
  return fields;
}

MATCHER_P2(IsError, code, reason, "") {
  *result_listener << "whose reason is " << ReasonOf(arg) << ", ";
  return testing::ExplainMatchResult(StatusIs(code), arg, result_listener) &&
         ReasonOf(arg) == reason;
}

}  // namespace ballpiston::server
