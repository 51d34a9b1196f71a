// A server on a Unix socket that sends the answers that a test has prepared.
#pragma once

#include <grpcpp/grpcpp.h>

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

// The messages and the final status that the server sends to one watch. With `hangs` it sends the
// final status only when the server stops.
struct WatchScript {
  std::vector<v1::WatchEnsembleJobResponse> messages;
  grpc::Status end;
  bool hangs = false;
};

class FakeEnsembleService final : public v1::EnsembleService::Service {
 public:
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
  bool answers_from_store = false;  // Create answers with this value of answered_from_store
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
  Requests Asked() const;

  grpc::Status CreateEnsembleJob(grpc::ServerContext*, const v1::CreateEnsembleJobRequest* request,
                                 v1::EnsembleJob* job) override;
  grpc::Status GetEnsembleJob(grpc::ServerContext*, const v1::GetEnsembleJobRequest* request,
                              v1::EnsembleJob* job) override;
  grpc::Status ListEnsembleJobs(grpc::ServerContext*, const v1::ListEnsembleJobsRequest* request,
                                v1::ListEnsembleJobsResponse* page) override;
  grpc::Status CancelEnsembleJob(grpc::ServerContext*, const v1::CancelEnsembleJobRequest* request,
                                 v1::EnsembleJob* job) override;
  grpc::Status UpdateEnsembleJob(grpc::ServerContext* context,
                                 const v1::UpdateEnsembleJobRequest* request,
                                 v1::EnsembleJob* job) override;
  grpc::Status DeleteEnsembleJob(grpc::ServerContext*, const v1::DeleteEnsembleJobRequest* request,
                                 google::protobuf::Empty*) override;
  grpc::Status WatchEnsembleJob(grpc::ServerContext*, const v1::WatchEnsembleJobRequest* request,
                                grpc::ServerWriter<v1::WatchEnsembleJobResponse>* writer) override;
  grpc::Status PlanEnsembleJob(grpc::ServerContext*, const v1::PlanEnsembleJobRequest* request,
                               v1::PlanEnsembleJobResponse* response) override;
  grpc::Status ListResults(grpc::ServerContext*, const v1::ListResultsRequest* request,
                           v1::ListResultsResponse* page) override;
  grpc::Status GetResult(grpc::ServerContext*, const v1::GetResultRequest* request,
                         v1::PointResult* point) override;

  void Release() { released_.count_down(); }  // ends watches that hang

 private:
  WatchScript NextScript(const v1::WatchEnsembleJobRequest& request);
  const v1::EnsembleJob* Find(const std::string& name) const;
  bool HasExpired(const std::string& name) const;

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

// INVALID_ARGUMENT with the details that a server attaches: one violation.
grpc::Status InvalidSpec(const std::string& field, const std::string& description);

// RESOURCE_EXHAUSTED with the details that a server attaches.
grpc::Status LimitExceeded(const std::string& reason, const std::string& message);

// NOT_FOUND with the details a server attaches.
grpc::Status JobNotFound(const std::string& name);

// NOT_FOUND with the details a server attaches.
grpc::Status ResultNotFound(const std::string& name);

// FAILED_PRECONDITION with the details that a server attaches. The fake server answers with it if a
// test sets results_expired of the job.
grpc::Status ResultsExpired(const std::string& name);

inline constexpr char kJobName[] = "ensembleJobs/abc";  // the name that JobIn gives

v1::WatchEnsembleJobResponse JobMessage(const v1::EnsembleJob& job, const std::string& token);
v1::WatchEnsembleJobResponse SnapshotMessage(double samples, const std::string& token);
v1::EnsembleJob JobIn(v1::EnsembleJob::State state);

}  // namespace ballpiston::client
