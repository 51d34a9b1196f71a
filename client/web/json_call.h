// Calls any method of the server with JSON. Methods are found in the API's descriptors, so a new
// method needs no code here.
#ifndef BALLPISTON_CLIENT_WEB_JSON_CALL_H_
#define BALLPISTON_CLIENT_WEB_JSON_CALL_H_

#include <google/protobuf/descriptor.h>
#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace ballpiston::client {

struct JsonCall {
  const google::protobuf::MethodDescriptor* method;
  std::string request;  // proto JSON; empty: {}
  absl::Duration timeout = absl::InfiniteDuration();
};

// `path` is SERVICE/METHOD, for instance ballpiston.v1.EnsembleService/GetEnsembleJob. Null if the
// API has no such method, or if its requests are a stream.
const google::protobuf::MethodDescriptor* FindMethod(absl::string_view path);

// The same call with a request id, if its request can have one and has none: so it may be repeated.
JsonCall WithRequestId(JsonCall call);

// Receives each answer as JSON, in the form of `--format json`. False ends the call, whose status
// is then OK.
using JsonReceiver = std::function<bool(const std::string& answer)>;

// The server's error as error_text.h renders it; INVALID_ARGUMENT if the request is not JSON of the
// method's request. Blocks. Safe to call from several threads.
absl::Status CallWithJson(const std::shared_ptr<grpc::Channel>& channel, const JsonCall& call,
                          const JsonReceiver& receive);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_WEB_JSON_CALL_H_
