// A whole server in the test's process, and a client of it. Fake experiments, requests and matchers
// of errors come with it.
//
//   RunningServer server;  // fake experiments, a Unix socket in a temporary folder
//   const std::string name = server.Submit(Equilibrium(2, 50));
//   EXPECT_EQ(server.AwaitEnd(name).state(), v1::EnsembleJob::SUCCEEDED);
//
//   RunningServer small({.workers = 1, .limits = {.max_streams = 1}});
#pragma once

#include "server/ballpiston_server.h"
#include "tests/server/calls.h"
#include "tests/server/error_details.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// ServerOptions with the defaults that tests want.
struct TestServerOptions {
  std::string data_dir = {};  // empty: a temporary folder, removed with the server
  std::string listen = {};    // empty: a Unix socket in the data folder
  DoorOptions door = {};
  int workers = 2;
  ExperimentFactory factory = FakeExperiments();  // null: the core's, by the chosen model
  WatchTiming watch = {.snapshot = std::chrono::milliseconds(2)};
  Limits limits = {};
  std::string metrics_listen = {};
  std::optional<ClusterOptions> cluster = {};
  // On a busy machine a commit may take long although the disk does not hang.
  Store::Options store = {.delay = std::chrono::milliseconds(1), .stall = kUnreachedLimit};
  std::shared_ptr<grpc::ChannelCredentials> credentials = nullptr;  // the client's; null: none
};

class RunningServer : public TestClient {
 public:
  // Throws, after a failed expectation, if the server does not start.
  explicit RunningServer(const TestServerOptions& options = {});

  BallpistonServer& server() { return *process_; }
  std::string address() const { return process_->address(); }
  // A channel with a connection of its own. Null: without credentials.
  std::shared_ptr<grpc::Channel> NewChannel(
      const std::shared_ptr<grpc::ChannelCredentials>& credentials = nullptr) const {
    return OwnChannel(address(), credentials);
  }
  void Shutdown(std::chrono::milliseconds drain = std::chrono::milliseconds(0)) {
    process_->Shutdown(drain);
  }

 private:
  const TemporaryFolder folder_;  // has the data if the options name no data folder
  std::unique_ptr<BallpistonServer> process_;
};

// The error of a server that does not start with these options. OK if it starts.
absl::Status StartError(const TestServerOptions& options);

}  // namespace ballpiston::server
