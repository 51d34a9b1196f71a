// A server's error as text for users and as a payload for programs.
//
// The server attaches a google.rpc.Status with an ErrorInfo (the reason, as one word) and, if the
// request is invalid, a BadRequest with every violation. The text is
//
//   MESSAGE (REASON)                              no violation
//   FIELD: DESCRIPTION (REASON)                   one violation
//   not valid, N violations (REASON):             several, one line each
//     FIELD: DESCRIPTION
//     and M more                                  if the server left some out
//
// The google.rpc.Status itself becomes the payload of the absl::Status.
//
// Three errors of gRPC get a plain text: one without a message, a message that is too large for the
// transport (with both sizes), and a method that the server lacks.
#pragma once

#include <grpcpp/support/status.h>

#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace ballpiston::client {

// In the text about a message that is too large for the transport.
inline constexpr char kTooLarge[] = "is too large to be sent";

// Type URL of the payload: a serialized google.rpc.Status.
inline constexpr char kStatusPayload[] = "type.googleapis.com/google.rpc.Status";

// The same code, with the text above as its message.
absl::Status FromGrpc(const grpc::Status& status);

// The details that the server attached to its error. Empty if the error is not the server's.
google::rpc::Status ErrorDetails(const absl::Status& status);

// The ErrorInfo's reason, e.g. "JOB_NOT_FOUND"; empty if the server gave no reason or was not
// reached.
std::string ErrorReason(const absl::Status& status);

// The least time to wait before a retry: the RetryInfo of the server's error; 0 without one.
absl::Duration RetryDelay(const absl::Status& status);

// The invalid fields of the request, by their paths: spec.grid.rho[0].
google::rpc::BadRequest ErrorViolations(const absl::Status& status);

}  // namespace ballpiston::client
