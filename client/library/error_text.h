// What a server's error says, for people and for programs.
//
// The server attaches a google.rpc.Status with an ErrorInfo (why, as one word) and, where the
// request is wrong, a BadRequest with every violation. The text is
//
//   MESSAGE (REASON)                              no violation, or one
//   not valid, N violations (REASON):             several, one line each
//     FIELD: DESCRIPTION
//     and M more                                  if the server left some out
//
// and the google.rpc.Status itself travels on as the absl::Status's payload.
//
// A message that is too large for the transport is told in plain words, with both sizes, and so is
// a method that the server lacks.
#ifndef BALLPISTON_CLIENT_LIBRARY_ERROR_TEXT_H_
#define BALLPISTON_CLIENT_LIBRARY_ERROR_TEXT_H_

#include <grpcpp/support/status.h>

#include <string>

#include "absl/status/status.h"

namespace ballpiston::client {

// Type URL of the payload: a serialized google.rpc.Status.
inline constexpr char kStatusPayload[] = "type.googleapis.com/google.rpc.Status";

// Same code, the text above as message.
absl::Status FromGrpc(const grpc::Status& status);

// The ErrorInfo's reason, e.g. "JOB_NOT_FOUND"; empty if the server gave none, as when it was
// never reached.
std::string ErrorReason(const absl::Status& status);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_ERROR_TEXT_H_
