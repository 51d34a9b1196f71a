// A channel with a connection of its own. Other channels to the same address share a connection,
// also a connection to a server that has ended.
#pragma once

#include "grpc/grpc.h"
#include "grpcpp/channel.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"
#include "grpcpp/support/channel_arguments.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// Each call ends after 15 minutes (kPatience) with DEADLINE_EXCEEDED. `credentials` null: none.
inline std::shared_ptr<grpc::Channel> OwnChannel(
    const std::string& address,
    const std::shared_ptr<grpc::ChannelCredentials>& credentials = nullptr,
    grpc::ChannelArguments arguments = {}) {
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);  // whatever http_proxy is
  const auto seconds = std::chrono::seconds(kPatience).count();
  arguments.SetServiceConfigJSON(R"({"methodConfig": [{"name": [{}], "timeout": ")" +
                                 std::to_string(seconds) + R"(s"}]})");
  return grpc::CreateCustomChannel(
      address, credentials != nullptr ? credentials : grpc::InsecureChannelCredentials(),
      arguments);
}

// The server can send at most 64 KiB ahead of a reader. By default the window grows.
inline grpc::ChannelArguments SmallWindow() {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  return arguments;
}

}  // namespace ballpiston::server
