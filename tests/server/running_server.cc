#include "tests/server/running_server.h"

#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// gRPC shuts down with the last server of a process. After large answers this may wait 10 s for one
// of gRPC's pollers. The reference that grpc_init takes here keeps gRPC open.
[[maybe_unused]] const bool kGrpcStaysOpen = [] {
  grpc_init();
  return true;
}();

ServerOptions OptionsIn(const std::string& data_dir, const TestServerOptions& options) {
  ServerOptions all;
  all.data_dir = data_dir;
  all.listen = options.listen;
  all.door = options.door;
  all.door.own_tokens = data_dir + "/tokens";
  all.workers = options.workers;
  if (options.factory) all.opener = std::make_shared<FactoryOpener>(options.factory);
  all.watch = options.watch;
  all.limits = options.limits;
  all.metrics_listen = options.metrics_listen;
  all.store = options.store;
  return all;
}

// A request that has only the name of a job.
template <typename Request>
Request Named(const std::string& name) {
  Request request;
  request.set_name(name);
  return request;
}

}  // namespace

// ---- TestClient ----

grpc::Status TestClient::Call(const google::protobuf::Message& request,
                              google::protobuf::Message* answer) const {
  std::string bytes;
  const grpc::Status status = CallByName(channel_, PathOf(*request.GetDescriptor()),
                                         request.SerializeAsString(), {}, &bytes);
  EXPECT_TRUE(answer == nullptr || answer->ParseFromString(bytes));
  return status;
}

std::string TestClient::Succeeded(const v1::EnsembleSpec& spec) const {
  const std::string name = Submit(spec);
  EXPECT_EQ(AwaitEnd(name).state(), v1::EnsembleJob::SUCCEEDED);
  return name;
}

v1::EnsembleJob TestClient::Get(const std::string& name) const {
  return Answered<v1::EnsembleJob>(Named<v1::GetEnsembleJobRequest>(name));
}

grpc::Status TestClient::Cancel(const std::string& name, const std::string& request_id) const {
  auto request = Named<v1::CancelEnsembleJobRequest>(name);
  request.set_request_id(request_id);
  return Call(request);
}

grpc::Status TestClient::Delete(const std::string& name) const {
  return Call(Named<v1::DeleteEnsembleJobRequest>(name));
}

// The last message has the job.
v1::EnsembleJob TestClient::AwaitEnd(const std::string& name) const {
  return Answered<v1::WatchEnsembleJobResponse>(Named<v1::WatchEnsembleJobRequest>(name)).job();
}

std::vector<std::string> TestClient::ResultBytes(const std::string& name) const {
  v1::ListResultsRequest request;
  request.set_parent(name);
  std::vector<std::string> bytes;
  for (const auto& page : Pages<v1::ListResultsResponse>(request)) {
    for (v1::PointResult result : page.results()) {
      result.clear_name();
      bytes.push_back(result.SerializeAsString());
    }
  }
  return bytes;
}

// ---- RunningServer ----

StartedServer::StartedServer(const TestServerOptions& options) {
  auto started = BallpistonServer::Start(
      OptionsIn(options.data_dir.empty() ? folder.path() : options.data_dir, options));
  EXPECT_OK(started);
  if (!started.ok()) throw std::runtime_error("the server does not start");
  process = *std::move(started);
}

RunningServer::RunningServer(const TestServerOptions& options)
    : StartedServer(options), TestClient(OwnChannel(process->address(), options.credentials)) {}

absl::Status StartError(const TestServerOptions& options) {
  const TemporaryFolder folder;
  return BallpistonServer::Start(
             OptionsIn(options.data_dir.empty() ? folder.path() : options.data_dir, options))
      .status();
}

}  // namespace ballpiston::server
