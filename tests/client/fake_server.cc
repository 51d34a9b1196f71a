#include "tests/client/fake_server.h"

#include <string>

#include "client/library/channel.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace ballpiston::client {

FakeServer::~FakeServer() {
  released_.count_down();
  if (server_) server_->Shutdown();
}

void FakeServer::Start() {
  if (server_ != nullptr) return;
  grpc::ServerBuilder builder;
  builder.AddListeningPort(Address(), grpc::InsecureServerCredentials());
  builder.SetMaxReceiveMessageSize(largest_request);
  builder.RegisterService(static_cast<v1::EnsembleService::Service*>(this));
  builder.RegisterService(static_cast<v1::AnalyticService::Service*>(this));
  builder.RegisterService(static_cast<v1::TraceService::Service*>(this));
  builder.RegisterService(static_cast<v1::ServerService::Service*>(this));
  server_ = builder.BuildAndStart();
}

std::shared_ptr<grpc::Channel> FakeServer::Channel() const { return *OpenChannel(Address()); }

const google::protobuf::Message* FakeServer::LastAsked(const std::string& call) const {
  const std::lock_guard lock(mutex_);
  const auto last = std::find_if(asked_.rbegin(), asked_.rend(), [&](const auto& request) {
    return request->GetDescriptor()->name() == call + "Request";
  });
  return last == asked_.rend() ? nullptr : last->get();
}

std::unique_lock<std::mutex> FakeServer::Record(const google::protobuf::Message& request) {
  std::unique_lock lock(mutex_);
  asked_.emplace_back(request.New())->CopyFrom(request);
  return lock;
}

grpc::Status FakeServer::Find(const std::string& name, v1::EnsembleJob* job) const {
  for (const v1::EnsembleJob& each : jobs) {
    if (each.name() != name) continue;
    *job = each;
    return grpc::Status::OK;
  }
  return WithReason(grpc::StatusCode::NOT_FOUND, "no such job: " + name, "JOB_NOT_FOUND");
}

grpc::Status FakeServer::FindWithResults(const std::string& name, v1::EnsembleJob* job) const {
  const grpc::Status found = Find(name, job);
  if (!found.ok() || !job->results_expired()) return found;
  return WithReason(grpc::StatusCode::FAILED_PRECONDITION, name + ": its results have expired",
                    "RESULTS_EXPIRED");
}

grpc::Status WithReason(grpc::StatusCode code, const std::string& message,
                        const std::string& reason) {
  google::rpc::ErrorInfo info;
  info.set_reason(reason);
  info.set_domain("ballpiston");
  google::rpc::Status details;
  details.add_details()->PackFrom(info);
  return grpc::Status(code, message, details.SerializeAsString());
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
