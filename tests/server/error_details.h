// The details of an error beside its code and message.
//
//   EXPECT_THAT(server.Delete(name), IsError(grpc::StatusCode::NOT_FOUND, "JOB_NOT_FOUND"));
#pragma once

#include "grpcpp/support/status.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

struct ErrorDetails {
  std::string reason;  // this and the next two are from google.rpc.ErrorInfo
  std::string domain;
  std::map<std::string, std::string> metadata;
  std::vector<std::string> fields;  // the fields of the violations in google.rpc.BadRequest
};

ErrorDetails DetailsOf(const grpc::Status& status);
ErrorDetails DetailsOf(const absl::Status& status);

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
