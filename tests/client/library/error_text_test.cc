#include "client/library/error_text.h"

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

TEST(ErrorText, OkStaysOk) { EXPECT_OK(FromGrpc(grpc::Status::OK)); }

TEST(ErrorText, WithoutDetailsTheTextIsTheMessage) {
  const absl::Status status =
      FromGrpc(grpc::Status(grpc::StatusCode::UNAVAILABLE, "connection refused"));
  EXPECT_EQ(status, absl::UnavailableError("connection refused"));
  EXPECT_EQ(ErrorReason(status), "");
}

TEST(ErrorText, OneViolationTakesOneLine) {
  const absl::Status status = FromGrpc(InvalidSpec("spec.grid.rho[0]", "is 0.9"));
  EXPECT_THAT(status, StatusIs(absl::StatusCode::kInvalidArgument,
                               "spec.grid.rho[0]: is 0.9 (INVALID_SPEC)"));
  EXPECT_EQ(ErrorReason(status), "INVALID_SPEC");
}

TEST(ErrorText, MalformedDetailsDoNotHideTheMessage) {
  EXPECT_EQ(FromGrpc(grpc::Status(grpc::StatusCode::INTERNAL, "went wrong", "\xff\xff\xff")),
            absl::InternalError("went wrong"));
}

}  // namespace
}  // namespace ballpiston::client
