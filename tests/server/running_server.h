// A whole server in the test's process, and clients of it. Fake experiments, requests and matchers
// of errors come with it.
//
//   RunningServer server;  // fake experiments, a Unix socket in a temporary folder
//   const std::string name = server.Submit(Equilibrium(2, 50));
//   EXPECT_EQ(server.AwaitEnd(name).state(), v1::EnsembleJob::SUCCEEDED);
//
//   RunningServer small({.workers = 1, .limits = {.max_streams = 1}});
#pragma once

#include "ballpiston/v1/analytic.grpc.pb.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "ballpiston/v1/server.grpc.pb.h"
#include "ballpiston/v1/trace.grpc.pb.h"
#include "grpcpp/channel.h"
#include "grpcpp/security/credentials.h"
#include "server/ballpiston_server.h"
#include "tests/server/error_details.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
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
  // On a busy machine a commit may take long although the disk does not hang.
  Store::Options store = {.delay = std::chrono::milliseconds(1), .stall = kUnreachedLimit};
  std::shared_ptr<grpc::ChannelCredentials> credentials = nullptr;  // the client's; null: none
};

// A channel, and frequent calls on it. Calls that do not return a status expect OK.
class TestClient {
 public:
  explicit TestClient(std::shared_ptr<grpc::Channel> channel);

  std::shared_ptr<grpc::Channel> channel() const { return channel_; }
  v1::EnsembleService::Stub& ensemble() { return *ensemble_; }
  v1::AnalyticService::Stub& analytic() { return *analytic_; }
  v1::TraceService::Stub& trace() { return *trace_; }

  grpc::Status Create(const v1::CreateEnsembleJobRequest& request, v1::EnsembleJob* job = nullptr);
  v1::EnsembleJob Created(const v1::CreateEnsembleJobRequest& request);
  std::string Submit(const v1::EnsembleSpec& spec);     // creates a new job; its name
  std::string Succeeded(const v1::EnsembleSpec& spec);  // the same, and waits for success
  v1::EnsembleJob Get(const std::string& name);
  grpc::Status Cancel(const std::string& name, const std::string& request_id = "");
  grpc::Status Delete(const std::string& name);
  v1::EnsembleJob AwaitEnd(const std::string& name);  // by watching it
  v1::ServerStatus Status();

  v1::ListEnsembleJobsResponse List(const v1::ListEnsembleJobsRequest& request = {});
  v1::ListResultsResponse Results(const v1::ListResultsRequest& request);
  // All pages, beginning with the page of `request`.
  std::vector<v1::ListEnsembleJobsResponse> Pages(v1::ListEnsembleJobsRequest request);
  std::vector<v1::ListResultsResponse> Pages(v1::ListResultsRequest request);
  // All results of a job, each serialized.
  std::vector<std::string> ResultBytes(const std::string& name);

 private:
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::EnsembleService::Stub> ensemble_;
  std::unique_ptr<v1::AnalyticService::Stub> analytic_;
  std::unique_ptr<v1::TraceService::Stub> trace_;
  std::unique_ptr<v1::ServerService::Stub> server_;
};

class RunningServer : public TestClient {
 public:
  // Throws, after a failed expectation, if the server does not start.
  explicit RunningServer(const TestServerOptions& options = {});

  BallpistonServer& server() { return *server_; }
  std::string address() const { return server_->address(); }
  // A channel with a connection of its own. Null: without credentials.
  std::shared_ptr<grpc::Channel> NewChannel(
      const std::shared_ptr<grpc::ChannelCredentials>& credentials = nullptr) const;
  void Shutdown(std::chrono::milliseconds drain = std::chrono::milliseconds(0)) {
    server_->Shutdown(drain);
  }

 private:
  struct Started {
    std::unique_ptr<TemporaryFolder> folder;  // null: the test owns the folder
    std::unique_ptr<BallpistonServer> server;
  };
  static Started Start(const TestServerOptions& options);
  RunningServer(Started started, const std::shared_ptr<grpc::ChannelCredentials>& credentials);

  std::unique_ptr<TemporaryFolder> folder_;
  std::unique_ptr<BallpistonServer> server_;
};

// The error of a server that does not start with these options. OK if it starts.
absl::Status StartError(const TestServerOptions& options);

}  // namespace ballpiston::server
