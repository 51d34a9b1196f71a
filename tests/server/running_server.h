// A whole server in the test's process, and clients of it. Fake experiments, requests and matchers
// of errors come with it.
//
//   RunningServer server;  // fake experiments, a Unix socket in a temporary folder
//   const std::string name = server.Submit(Equilibrium(2, 50));
//   EXPECT_EQ(server.AwaitEnd(name).state(), v1::EnsembleJob::SUCCEEDED);
//
//   RunningServer small({.workers = 1, .limits = {.max_streams = 1}});
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/server.pb.h"
#include "server/ballpiston_server.h"
#include "tests/server/error_details.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/own_channel.h"
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
  explicit TestClient(std::shared_ptr<grpc::Channel> channel) : channel_(std::move(channel)) {}

  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

  // A call with one answer. The type of the request decides its method.
  grpc::Status Call(const google::protobuf::Message& request,
                    google::protobuf::Message* answer = nullptr) const;
  template <typename Answer>
  Answer Answered(const google::protobuf::Message& request) const {
    Answer answer;
    EXPECT_OK(Call(request, &answer));
    return answer;
  }

  v1::EnsembleJob Created(const v1::CreateEnsembleJobRequest& request) const {
    return Answered<v1::EnsembleJob>(request);
  }
  std::string Submit(const v1::EnsembleSpec& spec) const {  // creates a new job; its name
    return Created(FreshRequest(spec)).name();
  }
  std::string Succeeded(const v1::EnsembleSpec& spec) const;  // the same, and waits for success
  v1::EnsembleJob Get(const std::string& name) const;
  grpc::Status Cancel(const std::string& name, const std::string& request_id = "") const;
  grpc::Status Delete(const std::string& name) const;
  v1::EnsembleJob AwaitEnd(const std::string& name) const;  // by watching it
  v1::ServerStatus Status() const {
    return Answered<v1::ServerStatus>(v1::GetServerStatusRequest());
  }

  v1::ListEnsembleJobsResponse List(const v1::ListEnsembleJobsRequest& request = {}) const {
    return Answered<v1::ListEnsembleJobsResponse>(request);
  }
  // All pages, beginning with the page of `request`.
  template <typename Page, typename Request>
  std::vector<Page> Pages(Request request) const {
    std::vector<Page> pages;
    do {
      pages.push_back(Answered<Page>(request));
      request.set_page_token(pages.back().next_page_token());
    } while (!request.page_token().empty());
    return pages;
  }
  // All results of a job, each serialized, without its name, which has the job's id.
  std::vector<std::string> ResultBytes(const std::string& name) const;

 private:
  std::shared_ptr<grpc::Channel> channel_;
};

// Throws, after a failed expectation, if the server does not start.
struct StartedServer {
  explicit StartedServer(const TestServerOptions& options);

  const TemporaryFolder folder;  // has the data if the options name no data folder
  std::unique_ptr<BallpistonServer> process;
};

class RunningServer : private StartedServer, public TestClient {
 public:
  explicit RunningServer(const TestServerOptions& options = {});

  BallpistonServer& server() { return *process; }
  std::string address() const { return process->address(); }
  // A channel with a connection of its own. Null: without credentials.
  std::shared_ptr<grpc::Channel> NewChannel(
      const std::shared_ptr<grpc::ChannelCredentials>& credentials = nullptr) const {
    return OwnChannel(address(), credentials);
  }
  void Shutdown(std::chrono::milliseconds drain = std::chrono::milliseconds(0)) {
    process->Shutdown(drain);
  }
};

// The error of a server that does not start with these options. OK if it starts.
absl::Status StartError(const TestServerOptions& options);

}  // namespace ballpiston::server
