// A server on a Unix socket that sends the answers that a test has prepared.
#pragma once

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <latch>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "ballpiston/v1/analytic.grpc.pb.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "ballpiston/v1/server.grpc.pb.h"
#include "ballpiston/v1/trace.grpc.pb.h"
#include "client/library/channel.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::client {

// An error with the details that a server attaches.
inline grpc::Status WithReason(grpc::StatusCode code, const std::string& message,
                               const std::string& reason) {
  google::rpc::ErrorInfo info;
  info.set_reason(reason);
  google::rpc::Status details;
  details.add_details()->PackFrom(info);
  return grpc::Status(code, message, details.SerializeAsString());
}

inline constexpr char kJobName[] = "ensembleJobs/abc";  // the name that JobIn gives

inline v1::WatchEnsembleJobResponse JobMessage(const v1::EnsembleJob& job,
                                               const std::string& token) {
  v1::WatchEnsembleJobResponse message;
  *message.mutable_job() = job;
  message.set_resume_token(token);
  return message;
}

inline v1::WatchEnsembleJobResponse SnapshotMessage(double samples, const std::string& token) {
  v1::WatchEnsembleJobResponse message;
  message.mutable_snapshot()->mutable_progress()->set_samples(samples);
  message.set_resume_token(token);
  return message;
}

inline v1::EnsembleJob JobIn(v1::EnsembleJob::State state) {
  v1::EnsembleJob job;
  job.set_name(kJobName);
  job.set_state(state);
  return job;
}

// The messages and the final status that the server sends to one watch. With `hangs` it sends the
// final status only when the server stops.
struct WatchScript {
  std::vector<v1::WatchEnsembleJobResponse> messages;
  grpc::Status end = {};
  bool hangs = false;
};

class FakeServer final : v1::EnsembleService::Service,
                         v1::AnalyticService::Service,
                         v1::TraceService::Service,
                         v1::ServerService::Service {
 public:
  FakeServer() = default;
  ~FakeServer() override {
    released_.count_down();
    if (server_) server_->Shutdown();
  }
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  // The answers. Tests set them before they use the server.
  std::vector<WatchScript> watches;  // one per watch; further watches use the last script
  std::vector<v1::EnsembleJob> jobs;
  std::vector<v1::EnsembleJob> created;  // by the first calls of create; the others get jobs[0]
  std::vector<v1::PointResult> points;
  v1::PlanEnsembleJobResponse plan;
  v1::EvaluatePairsResponse closed_forms;
  std::vector<v1::TraceOrbitResponse> orbit;
  v1::ServerStatus status;
  grpc::Status create_end, plan_end, trace_end;
  int unavailable_attempts = 0;  // the first attempts of create, cancel, update or delete that fail
  int page_size = 2;             // the largest page, whatever size the client requests
  int unavailable_later_pages = 0;  // failing attempts to list a page after the first page

  std::string Address() const { return "unix:" + SocketPath(); }
  std::string SocketPath() const { return folder_.File("socket"); }
  std::shared_ptr<grpc::Channel> Channel() const { return *OpenChannel(Address()); }
  // Set the answers before this call. Further calls do nothing.
  void Start() {
    if (server_ != nullptr) return;
    grpc::ServerBuilder builder;
    builder.AddListeningPort(Address(), grpc::InsecureServerCredentials());
    builder.RegisterService(static_cast<v1::EnsembleService::Service*>(this));
    builder.RegisterService(static_cast<v1::AnalyticService::Service*>(this));
    builder.RegisterService(static_cast<v1::TraceService::Service*>(this));
    builder.RegisterService(static_cast<v1::ServerService::Service*>(this));
    server_ = builder.BuildAndStart();
  }

  // The requests so far that have this type.
  template <typename Request>
  std::vector<Request> Asked() const {
    const std::lock_guard lock(mutex_);
    std::vector<Request> found;
    for (const auto& each : asked_) {
      if (const auto* request = dynamic_cast<const Request*>(each.get())) found.push_back(*request);
    }
    return found;
  }
  // The last request of a call, such as ListResults; null if there is none.
  const google::protobuf::Message* LastAsked(const std::string& call) const {
    const std::lock_guard lock(mutex_);
    const auto last = std::find_if(asked_.rbegin(), asked_.rend(), [&](const auto& request) {
      return request->GetDescriptor()->name() == call + "Request";
    });
    return last == asked_.rend() ? nullptr : last->get();
  }

 private:
  using Context = grpc::ServerContext;

  static inline const grpc::Status kNotYet{grpc::StatusCode::UNAVAILABLE, "not yet"};

  grpc::Status CreateEnsembleJob(Context*, const v1::CreateEnsembleJobRequest* request,
                                 v1::EnsembleJob* job) override {
    const auto lock = Record(*request);
    if (unavailable_attempts-- > 0) return kNotYet;
    if (!create_end.ok()) return create_end;
    *job = created_ < created.size() ? created[created_++] : jobs.at(0);
    return grpc::Status::OK;
  }

  grpc::Status GetEnsembleJob(Context*, const v1::GetEnsembleJobRequest* request,
                              v1::EnsembleJob* job) override {
    const auto lock = Record(*request);
    return Find(request->name(), job);
  }

  grpc::Status ListEnsembleJobs(Context*, const v1::ListEnsembleJobsRequest* request,
                                v1::ListEnsembleJobsResponse* page) override {
    const auto lock = Record(*request);
    FillPage(jobs, *request, std::min(page_size, request->page_size()), *page,
             *page->mutable_jobs());
    for (v1::EnsembleJob& job : *page->mutable_jobs()) {
      if (request->view() == v1::ListEnsembleJobsRequest::BASIC) job.mutable_spec()->clear_grid();
    }
    return grpc::Status::OK;
  }

  grpc::Status CancelEnsembleJob(Context*, const v1::CancelEnsembleJobRequest* request,
                                 v1::EnsembleJob* job) override {
    const auto lock = Record(*request);
    if (unavailable_attempts-- > 0) return kNotYet;
    *job = JobIn(v1::EnsembleJob::CANCELLED);
    job->set_name(request->name());
    const auto [first, is_new] = cancelled_.emplace(request->name(), request->request_id());
    if (first->second == request->request_id()) return grpc::Status::OK;
    return grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, "has ended already");
  }

  grpc::Status UpdateEnsembleJob(Context* context, const v1::UpdateEnsembleJobRequest* request,
                                 v1::EnsembleJob* job) override {
    const auto lock = Record(*request);
    if (unavailable_attempts-- > 0) {
      context->AddTrailingMetadata("grpc-retry-pushback-ms", "400");
      return kNotYet;
    }
    const grpc::Status found = FindWithResults(request->job().name(), job);
    job->set_pinned(request->job().pinned());
    return found;
  }

  grpc::Status DeleteEnsembleJob(Context*, const v1::DeleteEnsembleJobRequest* request,
                                 google::protobuf::Empty*) override {
    const auto lock = Record(*request);
    v1::EnsembleJob ignored;
    return unavailable_attempts-- > 0 ? kNotYet : Find(request->name(), &ignored);
  }

  grpc::Status WatchEnsembleJob(Context*, const v1::WatchEnsembleJobRequest* request,
                                grpc::ServerWriter<v1::WatchEnsembleJobResponse>* writer) override {
    v1::EnsembleJob ignored;
    if (const grpc::Status found = Find(request->name(), &ignored); !found.ok()) return found;
    auto lock = Record(*request);
    const WatchScript script = watches.at(std::min(watches_begun_++, watches.size() - 1));
    lock.unlock();
    for (const v1::WatchEnsembleJobResponse& message : script.messages) writer->Write(message);
    if (script.hangs) released_.wait();
    return script.end;
  }

  grpc::Status PlanEnsembleJob(Context*, const v1::PlanEnsembleJobRequest* request,
                               v1::PlanEnsembleJobResponse* response) override {
    const auto lock = Record(*request);
    *response = plan;
    return plan_end;
  }

  grpc::Status ListResults(Context*, const v1::ListResultsRequest* request,
                           v1::ListResultsResponse* page) override {
    const auto lock = Record(*request);
    v1::EnsembleJob job;
    const grpc::Status found = FindWithResults(request->parent(), &job);
    if (!found.ok()) return found;
    if (!request->page_token().empty() && unavailable_later_pages-- > 0) return kNotYet;
    FillPage(points, *request, page_size, *page, *page->mutable_results());
    for (v1::PointResult& point : *page->mutable_results()) {
      if (request->view() != v1::ListResultsRequest::BASIC) continue;
      point.clear_histograms();
      point.clear_curves();
    }
    return grpc::Status::OK;
  }

  grpc::Status GetResult(Context*, const v1::GetResultRequest* request,
                         v1::PointResult* point) override {
    const auto lock = Record(*request);
    v1::EnsembleJob job;
    const std::string name = request->name().substr(0, request->name().find("/results/"));
    if (const grpc::Status found = FindWithResults(name, &job); !found.ok()) return found;
    for (const v1::PointResult& each : points) {
      if (request->name() != name + "/results/" + std::to_string(each.index())) continue;
      *point = each;
      return grpc::Status::OK;
    }
    return WithReason(grpc::StatusCode::NOT_FOUND, "no such result: " + request->name(),
                      "RESULT_NOT_FOUND");
  }

  grpc::Status EvaluatePairs(Context*, const v1::EvaluatePairsRequest* request,
                             v1::EvaluatePairsResponse* answer) override {
    const auto lock = Record(*request);
    *answer = closed_forms;
    return grpc::Status::OK;
  }

  grpc::Status TraceOrbit(Context*, const v1::TraceOrbitRequest* request,
                          grpc::ServerWriter<v1::TraceOrbitResponse>* writer) override {
    Record(*request);
    for (const v1::TraceOrbitResponse& message : orbit) writer->Write(message);
    return trace_end;
  }

  grpc::Status GetServerStatus(Context*, const v1::GetServerStatusRequest* request,
                               v1::ServerStatus* answer) override {
    const auto lock = Record(*request);
    *answer = status;
    return grpc::Status::OK;
  }

  // The caller holds the lock while it makes its answer.
  std::unique_lock<std::mutex> Record(const google::protobuf::Message& request) {
    std::unique_lock lock(mutex_);
    asked_.emplace_back(request.New())->CopyFrom(request);
    return lock;
  }

  grpc::Status Find(const std::string& name, v1::EnsembleJob* job) const {
    for (const v1::EnsembleJob& each : jobs) {
      if (each.name() != name) continue;
      *job = each;
      return grpc::Status::OK;
    }
    return WithReason(grpc::StatusCode::NOT_FOUND, "no such job: " + name, "JOB_NOT_FOUND");
  }
  // Also fails if the job's results have expired.
  grpc::Status FindWithResults(const std::string& name, v1::EnsembleJob* job) const {
    const grpc::Status found = Find(name, job);
    if (!found.ok() || !job->results_expired()) return found;
    return WithReason(grpc::StatusCode::FAILED_PRECONDITION, name + ": its results have expired",
                      "RESULTS_EXPIRED");
  }

  // Copies `size` items into the page, from the place that its token names. The token of the next
  // page is the index of its first item.
  template <typename Item, typename Request, typename Page, typename List>
  static void FillPage(const std::vector<Item>& items, const Request& request, int size, Page& page,
                       List& list) {
    const size_t from = request.page_token().empty() ? 0 : std::stoul(request.page_token());
    const size_t to = std::min(from + static_cast<size_t>(size), items.size());
    for (size_t i = from; i < to; ++i) *list.Add() = items[i];
    if (to < items.size()) page.set_next_page_token(std::to_string(to));
  }

  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<google::protobuf::Message>> asked_;
  size_t created_ = 0, watches_begun_ = 0;
  std::map<std::string, std::string> cancelled_;  // the first request id of each job's name
  std::latch released_{1};                        // ends watches that hang
  const TemporaryFolder folder_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace ballpiston::client
