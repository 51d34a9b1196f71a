#include "tests/fault/torture/connected_server.h"

#include "tests/server/own_channel.h"

namespace ballpiston::torture {

std::shared_ptr<grpc::Channel> ConnectedServer::Connect() {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 200);
  auto channel = server::OwnChannel(address(), nullptr, arguments);
  const std::lock_guard lock(mutex_);
  channels_.push_back(channel);
  return channel;
}

// Ends the pause that gRPC makes after a failed attempt to connect.
void ConnectedServer::OnReady() {
  const std::lock_guard lock(mutex_);
  for (const std::weak_ptr<grpc::Channel>& channel : channels_) {
    const auto living = channel.lock();
    if (living) grpc::experimental::ChannelResetConnectionBackoff(living.get());
  }
}

}  // namespace ballpiston::torture
