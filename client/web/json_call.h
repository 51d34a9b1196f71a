// Calls any method of the server with JSON. Methods are found in the API's descriptors, so a new
// method needs no code here.
#pragma once

#include <google/protobuf/descriptor.h>

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "client/library/client.h"

namespace ballpiston::client {

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
