// The part of the Connect protocol (connectrpc.com/docs/protocol) that the gateway supports: unary
// calls and server streams, in JSON, without compression. Methods are found in the API's
// descriptors, so a new method needs no code here.
//
// A unary call is a POST of JSON. Its answer is JSON; an error is an HTTP status above 399 and
//   {"code": "not_found", "message": "...", "details": [{"type", "value", "debug"}]}
// Each message of a stream, also the request, is in an envelope: a byte of flags, the length as 4
// bytes, big-endian, and the JSON. The last envelope has the flag 2 and contains {} or
// {"error": {...}}.
#pragma once

#include <google/protobuf/descriptor.h>

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "client/library/client.h"

namespace ballpiston::client {

inline constexpr char kUnaryType[] = "application/json";
inline constexpr char kStreamType[] = "application/connect+json";

// The HTTP status for a code, from the table of the Connect protocol.
int HttpStatus(absl::StatusCode code);

// {"code", "message", "details"}: the details that the server attached, in base64 and as JSON.
std::string ErrorJson(const absl::Status& status);

std::string Envelope(absl::string_view message);
std::string EndOfStream(const absl::Status& status);

// The message in `body`, which must be exactly one envelope, else INVALID_ARGUMENT.
absl::StatusOr<std::string> OpenEnvelope(absl::string_view body);

// `path` is SERVICE/METHOD, for instance ballpiston.v1.EnsembleService/GetEnsembleJob. Null if the
// API has no such method, or if its requests are a stream.
const google::protobuf::MethodDescriptor* FindMethod(absl::string_view path);

// Receives each answer as JSON, in the form of `--format json`. If it returns false, the call ends
// with the status OK.
using JsonReceiver = std::function<bool(const std::string& answer)>;

// `json`: the request; empty: {}. Blocks. Returns the server's error with the text of
// error_text.h; INVALID_ARGUMENT if the request is not JSON of the method's request message.
// Thread-safe.
absl::Status CallWithJson(const Client& client, const google::protobuf::MethodDescriptor& method,
                          const std::string& json, absl::Duration timeout,
                          const JsonReceiver& receive);

}  // namespace ballpiston::client
