// Every torture test includes this header. It defines the size of the test, the server's process,
// the gRPC channels to the server, and the findings of the test.
//
// By default each test takes five seconds of one core or less, except the two tests Kills, which
// start a server for each failpoint. BALLPISTON_TORTURE=1 in the environment (`make torture`)
// selects the full size; BALLPISTON_TORTURE=0.1 selects a tenth.
#pragma once

#include <grpcpp/grpcpp.h>

#include "client/library/client.h"
#include "tests/fault/torture/findings.h"
#include "tests/server/calls.h"
#include "tests/support/preamble.h"
#include "tests/support/server_process.h"

namespace ballpiston::torture {

// The share of the full size; 0 in the short form.
inline double ShareOfFullSize() {
  const char* const share = std::getenv("BALLPISTON_TORTURE");
  return share == nullptr ? 0 : std::clamp(std::atof(share), 0.0, 1.0);
}

// `brief` in the short form; otherwise the share of `full`, at least `brief`.
inline int Size(int brief, int full) {
  return std::max(brief, static_cast<int>(ShareOfFullSize() * full));
}

// Whether to check times. A busy machine may miss them without an error of the server.
inline bool HoldsToTimes() { return ShareOfFullSize() > 0; }

class ConnectedServer : public ServerProcess {
 public:
  using ServerProcess::ServerProcess;

  // A channel with a connection of its own, not shared with other channels to the server. It
  // reconnects soon after a new process is ready; gRPC permits no shorter pause.
  std::shared_ptr<grpc::Channel> Connect() const {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
    arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 100);
    return server::OwnChannel(address(), nullptr, arguments);
  }
  client::Client NewClient() const {
    return client::Client(Connect(), absl::FromChrono(kPatience));
  }
};

}  // namespace ballpiston::torture
