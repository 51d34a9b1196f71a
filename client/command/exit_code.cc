#include "client/command/exit_code.h"

#include "absl/strings/match.h"
#include "client/library/error_text.h"

namespace ballpiston::client {
namespace {

// The server names a delay with a limit if a retry can help. Errors from gRPC's own limits, such as
// the size of a message, have no reason.
ExitCode OfLimit(const absl::Status& status) {
  if (RetryDelay(status) > absl::ZeroDuration()) return ExitCode::kUnreachable;
  const bool is_too_large = absl::StrContains(status.message(), kTooLarge);
  return ErrorReason(status).empty() && !is_too_large ? ExitCode::kFailed : ExitCode::kUsage;
}

}  // namespace

ExitCode ExitCodeOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return ExitCode::kDone;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kUnimplemented:
      return ExitCode::kUsage;
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kDeadlineExceeded:
      return ExitCode::kUnreachable;
    case absl::StatusCode::kResourceExhausted:
      return OfLimit(status);
    case absl::StatusCode::kNotFound:
      return ExitCode::kNotFound;
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnauthenticated:
      return ExitCode::kNotPermitted;
    default:
      return ExitCode::kFailed;
  }
}

ExitCode ExitCodeOf(int exit_status) {
  for (const ExitCode code :
       {ExitCode::kDone, ExitCode::kUsage, ExitCode::kUnreachable, ExitCode::kNotFound,
        ExitCode::kNotPermitted, ExitCode::kInterrupted}) {
    if (static_cast<int>(code) == exit_status) return code;
  }
  return ExitCode::kFailed;
}

}  // namespace ballpiston::client
