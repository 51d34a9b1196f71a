// What a server is doing, told by itself.
#ifndef BALLPISTON_CLIENT_LIBRARY_SERVER_CLIENT_H_
#define BALLPISTON_CLIENT_LIBRARY_SERVER_CLIENT_H_

#include <grpcpp/grpcpp.h>

#include <memory>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "ballpiston/v1/server.grpc.pb.h"

namespace ballpiston::client {

// Safe to share between threads. Errors are the server's (error_text.h); UNAVAILABLE or
// DEADLINE_EXCEEDED if it does not answer within `timeout`. A server measures its speed when it is
// asked for the first time, which takes a good part of a second.
class ServerClient {
 public:
  explicit ServerClient(const std::shared_ptr<grpc::ChannelInterface>& channel,
                        absl::Duration timeout = absl::Seconds(60));

  absl::StatusOr<v1::ServerStatus> Status() const;

 private:
  std::unique_ptr<v1::ServerService::StubInterface> stub_;
  absl::Duration timeout_;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_SERVER_CLIENT_H_
