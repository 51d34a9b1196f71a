#include "tests/client/fake_server.h"

#include <algorithm>
#include <string>

#include "client/library/channel.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace ballpiston::client {

grpc::Status FakeEnsembleService::CreateEnsembleJob(grpc::ServerContext*,
                                                    const v1::CreateEnsembleJobRequest* request,
                                                    v1::EnsembleJob* job) {
  const std::lock_guard lock(mutex_);
  asked_.create.push_back(*request);
  if (unavailable_attempts-- > 0) return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
  if (!create_end.ok()) return create_end;
  *job = jobs.at(0);
  if (asked_.create.size() <= created_states.size()) {
    job->set_state(created_states[asked_.create.size() - 1]);
  }
  job->set_answered_from_store(answers_from_store);
  return grpc::Status::OK;
}

FakeEnsembleService::Requests FakeEnsembleService::Asked() const {
  const std::lock_guard lock(mutex_);
  return asked_;
}

const v1::EnsembleJob* FakeEnsembleService::Find(const std::string& name) const {
  const auto found = std::find_if(jobs.begin(), jobs.end(),
                                  [&](const v1::EnsembleJob& job) { return job.name() == name; });
  return found == jobs.end() ? nullptr : &*found;
}

bool FakeEnsembleService::HasExpired(const std::string& name) const {
  const v1::EnsembleJob* const job = Find(name);
  return job != nullptr && job->results_expired();
}

grpc::Status FakeEnsembleService::GetEnsembleJob(grpc::ServerContext*,
                                                 const v1::GetEnsembleJobRequest* request,
                                                 v1::EnsembleJob* job) {
  const v1::EnsembleJob* found = Find(request->name());
  if (found == nullptr) return JobNotFound(request->name());
  *job = *found;
  return grpc::Status::OK;
}

grpc::Status FakeEnsembleService::ListEnsembleJobs(grpc::ServerContext*,
                                                   const v1::ListEnsembleJobsRequest* request,
                                                   v1::ListEnsembleJobsResponse* page) {
  const std::lock_guard lock(mutex_);
  asked_.list.push_back(*request);
  const size_t from = request->page_token().empty() ? 0 : std::stoul(request->page_token());
  const auto size = static_cast<size_t>(std::min(page_size, request->page_size()));
  const size_t to = std::min(from + size, jobs.size());
  for (size_t i = from; i < to; ++i) *page->add_jobs() = jobs[i];
  if (to < jobs.size()) page->set_next_page_token(std::to_string(to));
  return grpc::Status::OK;
}

grpc::Status FakeEnsembleService::CancelEnsembleJob(grpc::ServerContext*,
                                                    const v1::CancelEnsembleJobRequest* request,
                                                    v1::EnsembleJob* job) {
  const std::lock_guard lock(mutex_);
  asked_.cancel.push_back(*request);
  if (unavailable_attempts-- > 0) return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
  *job = JobIn(v1::EnsembleJob::CANCELLED);
  job->set_name(request->name());
  const auto first = std::find_if(
      asked_.cancel.begin(), asked_.cancel.end(),
      [&](const v1::CancelEnsembleJobRequest& asked) { return asked.name() == request->name(); });
  if (first->request_id() == request->request_id()) return grpc::Status::OK;
  return grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, "has ended already");
}

grpc::Status FakeEnsembleService::UpdateEnsembleJob(grpc::ServerContext* context,
                                                    const v1::UpdateEnsembleJobRequest* request,
                                                    v1::EnsembleJob* job) {
  const std::lock_guard lock(mutex_);
  asked_.update.push_back(*request);
  if (unavailable_attempts-- > 0) {
    if (!pushback.empty()) context->AddTrailingMetadata("grpc-retry-pushback-ms", pushback);
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
  }
  const std::string& name = request->job().name();
  if (Find(name) == nullptr) return JobNotFound(name);
  if (HasExpired(name)) return ResultsExpired(name);
  *job = *Find(name);
  job->set_pinned(request->job().pinned());
  return grpc::Status::OK;
}

grpc::Status FakeEnsembleService::DeleteEnsembleJob(grpc::ServerContext*,
                                                    const v1::DeleteEnsembleJobRequest* request,
                                                    google::protobuf::Empty*) {
  const std::lock_guard lock(mutex_);
  asked_.remove.push_back(*request);
  if (unavailable_attempts-- > 0) return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
  return Find(request->name()) == nullptr ? JobNotFound(request->name()) : grpc::Status::OK;
}

WatchScript FakeEnsembleService::NextScript(const v1::WatchEnsembleJobRequest& request) {
  const std::lock_guard lock(mutex_);
  asked_.watch.push_back(request);
  return watches.at(std::min(asked_.watch.size(), watches.size()) - 1);
}

grpc::Status FakeEnsembleService::WatchEnsembleJob(
    grpc::ServerContext*, const v1::WatchEnsembleJobRequest* request,
    grpc::ServerWriter<v1::WatchEnsembleJobResponse>* writer) {
  const WatchScript script = NextScript(*request);
  for (const v1::WatchEnsembleJobResponse& message : script.messages) writer->Write(message);
  if (script.hangs) released_.wait();
  return script.end;
}

grpc::Status FakeEnsembleService::PlanEnsembleJob(grpc::ServerContext*,
                                                  const v1::PlanEnsembleJobRequest* request,
                                                  v1::PlanEnsembleJobResponse* response) {
  const std::lock_guard lock(mutex_);
  asked_.plan.push_back(*request);
  *response = plan;
  return plan_end;
}

grpc::Status FakeEnsembleService::ListResults(grpc::ServerContext*,
                                              const v1::ListResultsRequest* request,
                                              v1::ListResultsResponse* page) {
  const std::lock_guard lock(mutex_);
  asked_.results.push_back(*request);
  if (HasExpired(request->parent())) return ResultsExpired(request->parent());
  if (!request->page_token().empty() && unavailable_later_pages-- > 0) {
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
  }
  const size_t from = request->page_token().empty() ? 0 : std::stoul(request->page_token());
  const size_t to = std::min(from + static_cast<size_t>(page_size), points.size());
  for (size_t i = from; i < to; ++i) *page->add_results() = points[i];
  if (to < points.size()) page->set_next_page_token(std::to_string(to));
  return grpc::Status::OK;
}

grpc::Status FakeEnsembleService::GetResult(grpc::ServerContext*,
                                            const v1::GetResultRequest* request,
                                            v1::PointResult* point) {
  const std::lock_guard lock(mutex_);
  asked_.result.push_back(*request);
  const std::string job = request->name().substr(0, request->name().find("/results/"));
  if (Find(job) == nullptr) return JobNotFound(job);
  if (HasExpired(job)) return ResultsExpired(job);
  for (const v1::PointResult& each : points) {
    if (request->name() != job + "/results/" + std::to_string(each.index())) continue;
    *point = each;
    return grpc::Status::OK;
  }
  return ResultNotFound(request->name());
}

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

grpc::Status LimitExceeded(const std::string& reason, const std::string& message) {
  return grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, message,
                      DetailsWithReason(reason).SerializeAsString());
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
