#include "tests/support/running_server.h"

#include <utility>

#include "google/rpc/status.pb.h"
#include "grpc/grpc.h"
#include "grpcpp/create_channel.h"
#include "gtest/gtest.h"

namespace ballpiston::server {
namespace {

// With the last server of a process gRPC shuts itself down, which after large answers may wait 10 s
// for a poller of its own: it is held open here.
[[maybe_unused]] const bool kGrpcStaysOpen = [] {
  grpc_init();
  return true;
}();

}  // namespace

ErrorDetails DetailsOf(const grpc::Status& status) {
  ErrorDetails details;
  google::rpc::Status rpc;
  rpc.ParseFromString(status.error_details());
  for (const auto& any : rpc.details()) {
    google::rpc::ErrorInfo info;
    google::rpc::BadRequest request;
    if (any.UnpackTo(&info)) details.reason = info.reason();
    if (!any.UnpackTo(&request)) continue;
    for (const auto& violation : request.field_violations()) {
      details.fields.push_back(violation.field());
    }
  }
  return details;
}

RunningServer::RunningServer(ServerOptions options) {
  options.store.stall = kNeverStalls;
  auto server = BallpistonServer::Start(std::move(options));
  EXPECT_TRUE(server.ok()) << server.status();
  server_ = *std::move(server);
  // A pool of its own: a later server at the same path is a new one.
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  channel_ =
      grpc::CreateCustomChannel(server_->address(), grpc::InsecureChannelCredentials(), arguments);
  ensemble_ = v1::EnsembleService::NewStub(channel_);
  analytic_ = v1::AnalyticService::NewStub(channel_);
  method_ = v1::MethodService::NewStub(channel_);
}

grpc::Status RunningServer::Create(const v1::CreateEnsembleJobRequest& request,
                                   v1::EnsembleJob* job) {
  grpc::ClientContext context;
  return ensemble_->CreateEnsembleJob(&context, request, job);
}

std::string RunningServer::Submit(const v1::EnsembleSpec& spec) {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  request.set_fresh(true);
  v1::EnsembleJob job;
  const grpc::Status status = Create(request, &job);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return job.name();
}

v1::EnsembleJob RunningServer::Get(const std::string& name) {
  grpc::ClientContext context;
  v1::GetEnsembleJobRequest request;
  request.set_name(name);
  v1::EnsembleJob job;
  const grpc::Status status = ensemble_->GetEnsembleJob(&context, request, &job);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return job;
}

grpc::Status RunningServer::Cancel(const std::string& name, const std::string& request_id) {
  grpc::ClientContext context;
  v1::CancelEnsembleJobRequest request;
  request.set_name(name);
  request.set_request_id(request_id);
  v1::EnsembleJob job;
  return ensemble_->CancelEnsembleJob(&context, request, &job);
}

grpc::Status RunningServer::Delete(const std::string& name) {
  grpc::ClientContext context;
  v1::DeleteEnsembleJobRequest request;
  request.set_name(name);
  google::protobuf::Empty empty;
  return ensemble_->DeleteEnsembleJob(&context, request, &empty);
}

v1::EnsembleJob RunningServer::AwaitEnd(const std::string& name) {
  grpc::ClientContext context;
  v1::WatchEnsembleJobRequest request;
  request.set_name(name);
  const auto stream = ensemble_->WatchEnsembleJob(&context, request);
  v1::WatchEnsembleJobResponse message;
  v1::EnsembleJob last;
  while (stream->Read(&message)) {
    if (message.has_job()) last = message.job();
  }
  const grpc::Status status = stream->Finish();
  EXPECT_TRUE(status.ok()) << status.error_message();
  return last;
}

std::vector<std::string> RunningServer::ResultBytes(const std::string& name) {
  std::vector<std::string> bytes;
  v1::ListResultsRequest request;
  request.set_parent(name);
  do {
    grpc::ClientContext context;
    v1::ListResultsResponse response;
    const grpc::Status status = ensemble_->ListResults(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    for (const auto& point : response.points()) bytes.push_back(point.SerializeAsString());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return bytes;
}

v1::EnsembleSpec Equilibrium(int points, int64_t collisions) {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::EQUILIBRIUM);
  spec.mutable_grid()->add_rho(0.53);
  for (int i = 0; i < points; ++i) spec.mutable_grid()->add_delta(0.1 + 1e-6 * i);
  spec.mutable_target()->set_collisions(collisions);
  spec.set_seed(1);
  return spec;
}

v1::EnsembleSpec SmallFirstHit() {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::FIRST_HIT);
  spec.mutable_grid()->add_rho(0.53);
  for (const double delta : {0.3, 0.25, 0.2}) spec.mutable_grid()->add_delta(delta);
  for (const double epsilon : {0.1, 0.4}) spec.mutable_grid()->add_epsilon(epsilon);
  spec.mutable_grid()->add_exponent(1);
  spec.mutable_target()->set_samples(4096);
  spec.set_seed(42);
  return spec;
}

}  // namespace ballpiston::server
