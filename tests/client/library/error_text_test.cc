#include "client/library/error_text.h"

#include <gtest/gtest.h>

#include <vector>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/client/fake_server.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using Violation = std::pair<std::string, std::string>;

grpc::Status InvalidWith(const std::vector<Violation>& violations, int left_out = 0) {
  google::rpc::ErrorInfo info;
  info.set_reason("INVALID_SPEC");
  if (left_out > 0) (*info.mutable_metadata())["violations_left_out"] = std::to_string(left_out);
  google::rpc::BadRequest request;
  for (const auto& [field, description] : violations) {
    auto* violation = request.add_field_violations();
    violation->set_field(field);
    violation->set_description(description);
  }
  google::rpc::Status details;
  details.add_details()->PackFrom(info);
  details.add_details()->PackFrom(request);
  return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "summary", details.SerializeAsString());
}

TEST(ErrorText, OkStaysOk) { EXPECT_OK(FromGrpc(grpc::Status::OK)); }

TEST(ErrorText, WithoutDetailsTheTextIsTheMessage) {
  const absl::Status status =
      FromGrpc(grpc::Status(grpc::StatusCode::UNAVAILABLE, "connection refused"));
  EXPECT_EQ(status, absl::UnavailableError("connection refused"));
  EXPECT_EQ(ErrorReason(status), "");
}

TEST(ErrorText, OneViolationTakesOneLine) {
  const absl::Status status = FromGrpc(InvalidWith({{"spec.grid.rho[0]", "is 0.9"}}));
  EXPECT_THAT(status, StatusIs(absl::StatusCode::kInvalidArgument,
                               "spec.grid.rho[0]: is 0.9 (INVALID_SPEC)"));
  EXPECT_EQ(ErrorReason(status), "INVALID_SPEC");
}

TEST(ErrorText, EveryViolationHasItsLine) {
  const absl::Status status =
      FromGrpc(InvalidWith({{"spec.grid.rho[0]", "is 0.9"}, {"spec.target.samples", "is 0"}}));
  EXPECT_EQ(status.message(),
            "not valid, 2 violations (INVALID_SPEC):\n"
            "  spec.grid.rho[0]: is 0.9\n"
            "  spec.target.samples: is 0");
}

TEST(ErrorText, CountsTheViolationsThatTheServerLeftOut) {
  const absl::Status status = FromGrpc(InvalidWith({{"spec.grid.rho[0]", "is 0.9"}}, 41));
  EXPECT_EQ(status.message(),
            "not valid, 42 violations (INVALID_SPEC):\n"
            "  spec.grid.rho[0]: is 0.9\n"
            "  and 41 more");
}

TEST(ErrorText, AReasonAloneFollowsTheMessage) {
  EXPECT_EQ(FromGrpc(JobNotFound("a")).message(), "no such job: a (JOB_NOT_FOUND)");
}

TEST(ErrorText, ATooLargeMessageIsReportedInPlainWords) {
  for (const char* text : {"Sent message larger than max (8000051 vs. 4194304)",
                           "SERVER: Received message larger than max (8000051 vs. 4194304)"}) {
    EXPECT_EQ(FromGrpc(grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, text)),
              absl::ResourceExhaustedError("the request or its answer is too large to be sent: "
                                           "8000051 bytes; at most 4194304 are permitted"));
  }
}

TEST(ErrorText, OtherExhaustionKeepsItsMessage) {
  EXPECT_EQ(FromGrpc(grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, "too many watchers")),
            absl::ResourceExhaustedError("too many watchers"));
}

TEST(ErrorText, AMissingMethodIsReportedInPlainWords) {
  EXPECT_EQ(FromGrpc(grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "")),
            absl::UnimplementedError(
                "the server has an earlier version, which does not offer this call"));
  EXPECT_EQ(FromGrpc(grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "not by Slurm")).message(),
            "not by Slurm");
}

TEST(ErrorText, MalformedDetailsDoNotHideTheMessage) {
  EXPECT_EQ(FromGrpc(grpc::Status(grpc::StatusCode::INTERNAL, "went wrong", "\xff\xff\xff")),
            absl::InternalError("went wrong"));
}

}  // namespace
}  // namespace ballpiston::client
