// A server on a Unix socket that sends the answers that a test has prepared.
#pragma once

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <latch>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "ballpiston/v1/analytic.grpc.pb.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "ballpiston/v1/server.grpc.pb.h"
#include "ballpiston/v1/trace.grpc.pb.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::client {

// An error with the details that a server attaches.
grpc::Status WithReason(grpc::StatusCode code, const std::string& message,
                        const std::string& reason);
grpc::Status JobNotFound(const std::string& name);

inline constexpr char kJobName[] = "ensembleJobs/abc";  // the name that JobIn gives

v1::WatchEnsembleJobResponse JobMessage(const v1::EnsembleJob& job, const std::string& token);
v1::WatchEnsembleJobResponse SnapshotMessage(double samples, const std::string& token);
v1::EnsembleJob JobIn(v1::EnsembleJob::State state);

// The messages and the final status that the server sends to one watch. With `hangs` it sends the
// final status only when the server stops.
struct WatchScript {
  std::vector<v1::WatchEnsembleJobResponse> messages;
  grpc::Status end = {};
  bool hangs = false;
};

class FakeEnsembleService final : public v1::EnsembleService::Service {
 public:
  using Context = grpc::ServerContext;

  // The answers. Tests set them before they use the server.
  std::vector<WatchScript> watches;  // one per watch; further watches use the last script
  std::vector<v1::EnsembleJob> jobs;
  std::vector<v1::PointResult> points;
  v1::PlanEnsembleJobResponse plan;
  grpc::Status plan_end;
  int unavailable_attempts = 0;  // the first attempts of create, cancel, update or delete that fail
  std::string pushback;  // milliseconds that failed attempts of update ask to wait; empty: none
  grpc::Status create_end;
  std::vector<v1::EnsembleJob::State> created_states;  // of the jobs that Create makes, in order
  int page_size = 2;                // the largest page, whatever size the client requests
  int unavailable_later_pages = 0;  // failing attempts to list a page after the first page

  // The requests so far.
  struct Requests {
    std::vector<v1::WatchEnsembleJobRequest> watch;
    std::vector<v1::CreateEnsembleJobRequest> create;
    std::vector<v1::ListEnsembleJobsRequest> list;
    std::vector<v1::CancelEnsembleJobRequest> cancel;
    std::vector<v1::UpdateEnsembleJobRequest> update;
    std::vector<v1::DeleteEnsembleJobRequest> remove;
    std::vector<v1::PlanEnsembleJobRequest> plan;
    std::vector<v1::ListResultsRequest> results;
    std::vector<v1::GetResultRequest> result;
  };
  Requests Asked() const {
    const std::lock_guard lock(mutex_);
    return asked_;
  }

  grpc::Status CreateEnsembleJob(Context*, const v1::CreateEnsembleJobRequest* request,
                                 v1::EnsembleJob* job) override {
    const std::lock_guard lock(mutex_);
    asked_.create.push_back(*request);
    if (unavailable_attempts-- > 0) return kNotYet;
    if (!create_end.ok()) return create_end;
    *job = jobs.at(0);
    if (asked_.create.size() <= created_states.size()) {
      job->set_state(created_states[asked_.create.size() - 1]);
    }
    return grpc::Status::OK;
  }

  grpc::Status GetEnsembleJob(Context*, const v1::GetEnsembleJobRequest* request,
                              v1::EnsembleJob* job) override {
    const v1::EnsembleJob* const found = Find(request->name());
    if (found != nullptr) *job = *found;
    return found != nullptr ? grpc::Status::OK : JobNotFound(request->name());
  }

  grpc::Status ListEnsembleJobs(Context*, const v1::ListEnsembleJobsRequest* request,
                                v1::ListEnsembleJobsResponse* page) override {
    const std::lock_guard lock(mutex_);
    asked_.list.push_back(*request);
    FillPage(jobs, *request, std::min(page_size, request->page_size()), *page,
             *page->mutable_jobs());
    for (v1::EnsembleJob& job : *page->mutable_jobs()) {
      if (request->view() == v1::ListEnsembleJobsRequest::BASIC) job.mutable_spec()->clear_grid();
    }
    return grpc::Status::OK;
  }

  grpc::Status CancelEnsembleJob(Context*, const v1::CancelEnsembleJobRequest* request,
                                 v1::EnsembleJob* job) override {
    const std::lock_guard lock(mutex_);
    asked_.cancel.push_back(*request);
    if (unavailable_attempts-- > 0) return kNotYet;
    *job = JobIn(v1::EnsembleJob::CANCELLED);
    job->set_name(request->name());
    const auto first = std::find_if(
        asked_.cancel.begin(), asked_.cancel.end(),
        [&](const v1::CancelEnsembleJobRequest& asked) { return asked.name() == request->name(); });
    if (first->request_id() == request->request_id()) return grpc::Status::OK;
    return grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, "has ended already");
  }

  grpc::Status UpdateEnsembleJob(Context* context, const v1::UpdateEnsembleJobRequest* request,
                                 v1::EnsembleJob* job) override {
    const std::lock_guard lock(mutex_);
    asked_.update.push_back(*request);
    if (unavailable_attempts-- > 0) {
      if (!pushback.empty()) context->AddTrailingMetadata("grpc-retry-pushback-ms", pushback);
      return kNotYet;
    }
    const grpc::Status found = HasResults(request->job().name());
    if (!found.ok()) return found;
    *job = *Find(request->job().name());
    job->set_pinned(request->job().pinned());
    return grpc::Status::OK;
  }

  grpc::Status DeleteEnsembleJob(Context*, const v1::DeleteEnsembleJobRequest* request,
                                 google::protobuf::Empty*) override {
    const std::lock_guard lock(mutex_);
    asked_.remove.push_back(*request);
    if (unavailable_attempts-- > 0) return kNotYet;
    return Find(request->name()) == nullptr ? JobNotFound(request->name()) : grpc::Status::OK;
  }

  grpc::Status WatchEnsembleJob(Context*, const v1::WatchEnsembleJobRequest* request,
                                grpc::ServerWriter<v1::WatchEnsembleJobResponse>* writer) override {
    if (!jobs.empty() && Find(request->name()) == nullptr) return JobNotFound(request->name());
    const WatchScript script = NextScript(*request);
    for (const v1::WatchEnsembleJobResponse& message : script.messages) writer->Write(message);
    if (script.hangs) released_.wait();
    return script.end;
  }

  grpc::Status PlanEnsembleJob(Context*, const v1::PlanEnsembleJobRequest* request,
                               v1::PlanEnsembleJobResponse* response) override {
    const std::lock_guard lock(mutex_);
    asked_.plan.push_back(*request);
    *response = plan;
    return plan_end;
  }

  grpc::Status ListResults(Context*, const v1::ListResultsRequest* request,
                           v1::ListResultsResponse* page) override {
    const std::lock_guard lock(mutex_);
    asked_.results.push_back(*request);
    // Some tests set points but no job, so an unknown job has these points too.
    const grpc::Status found = HasResults(request->parent());
    if (found.error_code() != grpc::StatusCode::NOT_FOUND && !found.ok()) return found;
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
    const std::lock_guard lock(mutex_);
    asked_.result.push_back(*request);
    const std::string job = request->name().substr(0, request->name().find("/results/"));
    if (const grpc::Status found = HasResults(job); !found.ok()) return found;
    for (const v1::PointResult& each : points) {
      if (request->name() != job + "/results/" + std::to_string(each.index())) continue;
      *point = each;
      return grpc::Status::OK;
    }
    return WithReason(grpc::StatusCode::NOT_FOUND, "no such result: " + request->name(),
                      "RESULT_NOT_FOUND");
  }

  void Release() { released_.count_down(); }  // ends watches that hang

 private:
  static inline const grpc::Status kNotYet{grpc::StatusCode::UNAVAILABLE, "not yet"};

  WatchScript NextScript(const v1::WatchEnsembleJobRequest& request) {
    const std::lock_guard lock(mutex_);
    asked_.watch.push_back(request);
    return watches.at(std::min(asked_.watch.size(), watches.size()) - 1);
  }

  const v1::EnsembleJob* Find(const std::string& name) const {
    const auto found = std::find_if(jobs.begin(), jobs.end(),
                                    [&](const v1::EnsembleJob& job) { return job.name() == name; });
    return found == jobs.end() ? nullptr : &*found;
  }

  // OK if the job exists and its results have not expired.
  grpc::Status HasResults(const std::string& name) const {
    const v1::EnsembleJob* const job = Find(name);
    if (job == nullptr) return JobNotFound(name);
    if (!job->results_expired()) return grpc::Status::OK;
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
  Requests asked_;
  std::latch released_{1};
};

class FakeAnalyticService final : public v1::AnalyticService::Service {
 public:
  v1::EvaluatePairsResponse response;
  v1::EvaluatePairsRequest asked;  // the last request
  grpc::Status EvaluatePairs(grpc::ServerContext*, const v1::EvaluatePairsRequest* request,
                             v1::EvaluatePairsResponse* answer) override {
    asked = *request;
    *answer = response;
    return grpc::Status::OK;
  }
};

class FakeTraceService final : public v1::TraceService::Service {
 public:
  std::vector<v1::TraceOrbitResponse> messages;
  grpc::Status end;
  v1::TraceOrbitRequest asked;  // the last request
  grpc::Status TraceOrbit(grpc::ServerContext*, const v1::TraceOrbitRequest* request,
                          grpc::ServerWriter<v1::TraceOrbitResponse>* writer) override {
    asked = *request;
    for (const v1::TraceOrbitResponse& message : messages) writer->Write(message);
    return end;
  }
};

class FakeServerService final : public v1::ServerService::Service {
 public:
  v1::ServerStatus status;
  grpc::Status GetServerStatus(grpc::ServerContext*, const v1::GetServerStatusRequest*,
                               v1::ServerStatus* answer) override {
    *answer = status;
    return grpc::Status::OK;
  }
};

class FakeServer {
 public:
  FakeServer() = default;
  ~FakeServer();
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  FakeEnsembleService ensemble;
  FakeAnalyticService analytic;
  FakeTraceService trace;
  FakeServerService server;
  int largest_request = 4 << 20;  // bytes; -1: any

  std::string Address() const { return "unix:" + SocketPath(); }
  std::string SocketPath() const { return folder_.File("socket"); }
  std::shared_ptr<grpc::Channel> Channel() const;  // made by OpenChannel
  // Set the answers before this call. Further calls do nothing.
  void Start();

 private:
  const TemporaryFolder folder_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace ballpiston::client
