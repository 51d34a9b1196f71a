#include "tests/client/fake_server.h"

#include <string>

#include "client/library/channel.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace ballpiston::client {

FakeServer::~FakeServer() {
  ensemble.Release();
  if (server_) server_->Shutdown();
}

void FakeServer::Start() {
  if (server_ != nullptr) return;
  grpc::ServerBuilder builder;
  builder.AddListeningPort(Address(), grpc::InsecureServerCredentials());
  builder.SetMaxReceiveMessageSize(largest_request);
  builder.RegisterService(&ensemble);
  builder.RegisterService(&analytic);
  builder.RegisterService(&trace);
  builder.RegisterService(&server);
  server_ = builder.BuildAndStart();
}

std::shared_ptr<grpc::Channel> FakeServer::Channel() const { return *OpenChannel(Address()); }

namespace {

google::rpc::Status DetailsWithReason(const std::string& reason) {
  google::rpc::ErrorInfo info;
  info.set_reason(reason);
  info.set_domain("ballpiston");
  google::rpc::Status details;
  details.add_details()->PackFrom(info);
  return details;
}

}  // namespace

grpc::Status InvalidSpec(const std::string& field, const std::string& description) {
  google::rpc::BadRequest request;
  auto* violation = request.add_field_violations();
  violation->set_field(field);
  violation->set_description(description);
  google::rpc::Status details = DetailsWithReason("INVALID_SPEC");
  details.add_details()->PackFrom(request);
  return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "the specification is not valid",
                      details.SerializeAsString());
}

grpc::Status JobNotFound(const std::string& name) {
  return grpc::Status(grpc::StatusCode::NOT_FOUND, "no such job: " + name,
                      DetailsWithReason("JOB_NOT_FOUND").SerializeAsString());
}

grpc::Status ResultNotFound(const std::string& name) {
  return grpc::Status(grpc::StatusCode::NOT_FOUND, "no such result: " + name,
                      DetailsWithReason("RESULT_NOT_FOUND").SerializeAsString());
}

grpc::Status ResultsExpired(const std::string& name) {
  return grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, name + ": its results have expired",
                      DetailsWithReason("RESULTS_EXPIRED").SerializeAsString());
}

v1::WatchEnsembleJobResponse JobMessage(const v1::EnsembleJob& job, const std::string& token) {
  v1::WatchEnsembleJobResponse message;
  *message.mutable_job() = job;
  message.set_resume_token(token);
  return message;
}

v1::WatchEnsembleJobResponse SnapshotMessage(double samples, const std::string& token) {
  v1::WatchEnsembleJobResponse message;
  message.mutable_snapshot()->mutable_progress()->set_samples(samples);
  message.set_resume_token(token);
  return message;
}

v1::EnsembleJob JobIn(v1::EnsembleJob::State state) {
  v1::EnsembleJob job;
  job.set_name(kJobName);
  job.set_state(state);
  return job;
}

}  // namespace ballpiston::client
