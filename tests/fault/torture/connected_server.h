// A server process, and gRPC channels to it.
#pragma once

#include <grpcpp/grpcpp.h>

#include "client/library/client.h"
#include "tests/support/preamble.h"
#include "tests/support/server_process.h"

namespace ballpiston::torture {

// The pause before a client repeats a call that the server did not answer.
inline constexpr std::chrono::milliseconds kPauseBeforeRepeating(20);

class ConnectedServer : public ServerProcess {
 public:
  using ServerProcess::ServerProcess;

  // A channel with a connection of its own, not shared with other channels to the server. It
  // reconnects as soon as a new process is ready.
  std::shared_ptr<grpc::Channel> Connect();
  client::Client NewClient() { return client::Client(Connect(), absl::FromChrono(kPatience)); }

 private:
  void OnReady() override;

  std::mutex mutex_;
  std::vector<std::weak_ptr<grpc::Channel>> channels_;
};

}  // namespace ballpiston::torture
