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

// Expects OK.
template <typename Stub, typename Request, typename Response>
Response AnswerOf(Stub& stub,
                  grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                  const Request& request) {
  grpc::ClientContext context;
  Response response;
  EXPECT_OK((stub.*method)(&context, request, &response));
  return response;
}

template <typename Response, typename Request, typename Fetch>
std::vector<Response> AllPages(Request request, Fetch fetch) {
  std::vector<Response> pages;
  do {
    pages.push_back(fetch(request));
    request.set_page_token(pages.back().next_page_token());
  } while (!request.page_token().empty());
  return pages;
}

}  // namespace

// ---- TestClient ----

TestClient::TestClient(std::shared_ptr<grpc::Channel> channel)
    : channel_(std::move(channel)),
      ensemble_(v1::EnsembleService::NewStub(channel_)),
      analytic_(v1::AnalyticService::NewStub(channel_)),
      trace_(v1::TraceService::NewStub(channel_)),
      server_(v1::ServerService::NewStub(channel_)) {}

grpc::Status TestClient::Create(const v1::CreateEnsembleJobRequest& request, v1::EnsembleJob* job) {
  grpc::ClientContext context;
  v1::EnsembleJob unwanted;
  return ensemble_->CreateEnsembleJob(&context, request, job != nullptr ? job : &unwanted);
}

v1::EnsembleJob TestClient::Created(const v1::CreateEnsembleJobRequest& request) {
  return AnswerOf(*ensemble_, &v1::EnsembleService::Stub::CreateEnsembleJob, request);
}

std::string TestClient::Submit(const v1::EnsembleSpec& spec) {
  return Created(FreshRequest(spec)).name();
}

std::string TestClient::Succeeded(const v1::EnsembleSpec& spec) {
  const std::string name = Submit(spec);
  EXPECT_EQ(AwaitEnd(name).state(), v1::EnsembleJob::SUCCEEDED);
  return name;
}

v1::EnsembleJob TestClient::Get(const std::string& name) {
  v1::GetEnsembleJobRequest request;
  request.set_name(name);
  return AnswerOf(*ensemble_, &v1::EnsembleService::Stub::GetEnsembleJob, request);
}

grpc::Status TestClient::Cancel(const std::string& name, const std::string& request_id) {
  grpc::ClientContext context;
  v1::CancelEnsembleJobRequest request;
  request.set_name(name);
  request.set_request_id(request_id);
  v1::EnsembleJob job;
  return ensemble_->CancelEnsembleJob(&context, request, &job);
}

grpc::Status TestClient::Delete(const std::string& name) {
  grpc::ClientContext context;
  v1::DeleteEnsembleJobRequest request;
  request.set_name(name);
  google::protobuf::Empty empty;
  return ensemble_->DeleteEnsembleJob(&context, request, &empty);
}

v1::EnsembleJob TestClient::AwaitEnd(const std::string& name) {
  grpc::ClientContext context;
  v1::WatchEnsembleJobRequest request;
  request.set_name(name);
  const auto stream = ensemble_->WatchEnsembleJob(&context, request);
  v1::WatchEnsembleJobResponse message;
  v1::EnsembleJob last;
  while (stream->Read(&message)) {
    if (message.has_job()) last = message.job();
  }
  EXPECT_OK(stream->Finish());
  return last;
}

v1::ServerStatus TestClient::Status() {
  return AnswerOf(*server_, &v1::ServerService::Stub::GetServerStatus, {});
}

v1::ListEnsembleJobsResponse TestClient::List(const v1::ListEnsembleJobsRequest& request) {
  return AnswerOf(*ensemble_, &v1::EnsembleService::Stub::ListEnsembleJobs, request);
}

v1::ListResultsResponse TestClient::Results(const v1::ListResultsRequest& request) {
  return AnswerOf(*ensemble_, &v1::EnsembleService::Stub::ListResults, request);
}

std::vector<v1::ListEnsembleJobsResponse> TestClient::Pages(v1::ListEnsembleJobsRequest request) {
  return AllPages<v1::ListEnsembleJobsResponse>(std::move(request),
                                                [this](const auto& page) { return List(page); });
}

std::vector<v1::ListResultsResponse> TestClient::Pages(v1::ListResultsRequest request) {
  return AllPages<v1::ListResultsResponse>(std::move(request),
                                           [this](const auto& page) { return Results(page); });
}

std::vector<std::string> TestClient::ResultBytes(const std::string& name) {
  v1::ListResultsRequest request;
  request.set_parent(name);
  std::vector<std::string> bytes;
  for (const auto& page : Pages(request)) {
    for (v1::PointResult result : page.results()) {
      result.clear_name();  // has the job's id
      bytes.push_back(result.SerializeAsString());
    }
  }
  return bytes;
}

// ---- RunningServer ----

RunningServer::RunningServer(const TestServerOptions& options)
    : RunningServer(Start(options), options.credentials) {}

RunningServer::RunningServer(Started started,
                             const std::shared_ptr<grpc::ChannelCredentials>& credentials)
    : TestClient(OwnChannel(started.server->address(), credentials)),
      folder_(std::move(started.folder)),
      server_(std::move(started.server)) {}

RunningServer::Started RunningServer::Start(const TestServerOptions& options) {
  Started started;
  if (options.data_dir.empty()) started.folder = std::make_unique<TemporaryFolder>();
  auto server = BallpistonServer::Start(
      OptionsIn(started.folder != nullptr ? started.folder->path() : options.data_dir, options));
  EXPECT_OK(server);
  if (!server.ok()) throw std::runtime_error("the server does not start");
  started.server = *std::move(server);
  return started;
}

std::shared_ptr<grpc::Channel> RunningServer::NewChannel(
    const std::shared_ptr<grpc::ChannelCredentials>& credentials) const {
  return OwnChannel(address(), credentials);
}

absl::Status StartError(const TestServerOptions& options) {
  const TemporaryFolder folder;
  return BallpistonServer::Start(
             OptionsIn(options.data_dir.empty() ? folder.path() : options.data_dir, options))
      .status();
}

}  // namespace ballpiston::server
