#include "client/library/error_text.h"

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// transcripts/refusals.txt shows the texts of details.
TEST(ErrorText, OkStaysOk) { EXPECT_OK(FromGrpc(grpc::Status::OK)); }

TEST(ErrorText, WithoutDetailsTheTextIsTheMessage) {
  const absl::Status status =
      FromGrpc(grpc::Status(grpc::StatusCode::UNAVAILABLE, "connection refused"));
  EXPECT_EQ(status, absl::UnavailableError("connection refused"));
  EXPECT_EQ(ErrorReason(status), "");
}

TEST(ErrorText, MalformedDetailsDoNotHideTheMessage) {
  EXPECT_EQ(FromGrpc(grpc::Status(grpc::StatusCode::INTERNAL, "went wrong", "\xff\xff\xff")),
            absl::InternalError("went wrong"));
}

}  // namespace
}  // namespace ballpiston::client
