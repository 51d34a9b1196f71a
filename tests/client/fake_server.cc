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

grpc::Status WithReason(grpc::StatusCode code, const std::string& message,
                        const std::string& reason) {
  google::rpc::ErrorInfo info;
  info.set_reason(reason);
  info.set_domain("ballpiston");
  google::rpc::Status details;
  details.add_details()->PackFrom(info);
  return grpc::Status(code, message, details.SerializeAsString());
}

grpc::Status JobNotFound(const std::string& name) {
  return WithReason(grpc::StatusCode::NOT_FOUND, "no such job: " + name, "JOB_NOT_FOUND");
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
