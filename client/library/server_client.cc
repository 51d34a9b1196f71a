#include "client/library/server_client.h"

#include "client/library/unary_call.h"

namespace ballpiston::client {

ServerClient::ServerClient(const std::shared_ptr<grpc::ChannelInterface>& channel,
                           absl::Duration timeout)
    : stub_(v1::ServerService::NewStub(channel)), timeout_(timeout) {}

absl::StatusOr<v1::ServerStatus> ServerClient::Status() const {
  return CallUnary(*stub_, &v1::ServerService::StubInterface::GetServerStatus,
                   v1::GetServerStatusRequest(), timeout_);
}

}  // namespace ballpiston::client
