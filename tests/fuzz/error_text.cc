// How the client reads an error from a server, with and without details.
#include "client/library/error_text.h"

#include "google/rpc/status.pb.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

void RequireRead(grpc::StatusCode code, const std::string& message, const std::string& details) {
  const absl::Status read = client::FromGrpc(grpc::Status(code, message, details));
  Require(static_cast<int>(read.code()) == static_cast<int>(code), "the code stays");
  const std::string reason = client::ErrorReason(read);
  Require(reason.size() <= details.size(), "a reason is the server's");
}

void CheckErrorText(const std::string& bytes) {
  constexpr int kCodes = 16;
  const auto code = static_cast<grpc::StatusCode>(1 + bytes.size() % kCodes);
  google::rpc::Status details;
  if (details.ParseFromString(bytes)) RequireRead(code, details.message(), bytes);
  RequireRead(code, bytes, "");
  RequireRead(grpc::StatusCode::RESOURCE_EXHAUSTED, bytes, "");
}

const Registration kErrorText({.name = "error_text",
                               .check = CheckErrorText,
                               .message = &google::rpc::Status::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
