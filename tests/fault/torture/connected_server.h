// A server process, and gRPC channels to it.
#pragma once

#include <grpcpp/grpcpp.h>

#include "client/library/client.h"
#include "tests/server/calls.h"
#include "tests/support/preamble.h"
#include "tests/support/server_process.h"

namespace ballpiston::torture {

class ConnectedServer : public ServerProcess {
 public:
  using ServerProcess::ServerProcess;

  // A channel with a connection of its own, not shared with other channels to the server. It
  // reconnects as soon as a new process is ready.
  std::shared_ptr<grpc::Channel> Connect() {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
    arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 200);
    auto channel = server::OwnChannel(address(), nullptr, arguments);
    const std::lock_guard lock(mutex_);
    channels_.push_back(channel);
    return channel;
  }
  client::Client NewClient() { return client::Client(Connect(), absl::FromChrono(kPatience)); }

 private:
  // Ends the pause that gRPC makes after a failed attempt to connect.
  void OnReady() override {
    const std::lock_guard lock(mutex_);
    for (const std::weak_ptr<grpc::Channel>& channel : channels_) {
      const auto living = channel.lock();
      if (living) grpc::experimental::ChannelResetConnectionBackoff(living.get());
    }
  }

  std::mutex mutex_;
  std::vector<std::weak_ptr<grpc::Channel>> channels_;
};

}  // namespace ballpiston::torture
