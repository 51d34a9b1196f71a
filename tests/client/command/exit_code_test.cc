#include "client/command/exit_code.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

TEST(ExitCode, FollowsFromTheStatus) {
  const std::pair<absl::StatusCode, int> table[] = {{absl::StatusCode::kOk, 0},
                                                    {absl::StatusCode::kInvalidArgument, 2},
                                                    {absl::StatusCode::kOutOfRange, 2},
                                                    {absl::StatusCode::kUnimplemented, 2},
                                                    {absl::StatusCode::kUnavailable, 3},
                                                    {absl::StatusCode::kDeadlineExceeded, 3},
                                                    {absl::StatusCode::kFailedPrecondition, 4},
                                                    {absl::StatusCode::kInternal, 4},
                                                    {absl::StatusCode::kCancelled, 4},
                                                    {absl::StatusCode::kResourceExhausted, 4},
                                                    {absl::StatusCode::kNotFound, 5},
                                                    {absl::StatusCode::kPermissionDenied, 6},
                                                    {absl::StatusCode::kUnauthenticated, 6}};
  for (const auto& [code, expected] : table) {
    EXPECT_EQ(static_cast<int>(ExitCodeOf(absl::Status(code, "text"))), expected)
        << absl::StatusCodeToString(code);
  }
}

TEST(ExitCode, OfAChildProgramIsItsStatusOrFour) {
  for (const int status : {0, 2, 3, 4, 5, 6, 130}) {
    EXPECT_EQ(static_cast<int>(ExitCodeOf(status)), status);
  }
  for (const int status : {1, 7, 127, 143}) EXPECT_EQ(ExitCodeOf(status), ExitCode::kFailed);
}

}  // namespace
}  // namespace ballpiston::client
