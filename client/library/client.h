// A server's API: jobs (submit, look up, watch, cancel, pin, delete, fetch results), closed forms,
// traces, and the server itself.
//
//   auto channel = OpenChannel("localhost:50051");
//   Client client(*channel);
//   absl::StatusOr<v1::EnsembleJob> job = client.Create(spec);
//   job = client.Watch(job->name(), {});
//   absl::StatusOr<std::vector<v1::PointResult>> points = client.Results(job->name());
//
// An error has the server's code and the text that error_text.h makes from its details. UNAVAILABLE
// or DEADLINE_EXCEEDED if the server cannot be reached. Thread-safe.
#pragma once

#include <grpcpp/grpcpp.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "ballpiston/v1/analytic.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/server.pb.h"
#include "ballpiston/v1/trace.pb.h"
#include "client/library/job_watch.h"

namespace ballpiston::client {

inline constexpr absl::Duration kCallTimeout = absl::Seconds(60);

// Starts a stopped server again. OK also if the server is running.
using Revival = std::function<absl::Status()>;

class Client {
 public:
  // `timeout` limits each single call, but not a stream. `revival` is used if the server is
  // unavailable. A call that is safe to repeat then starts the server and is repeated once, with
  // the same request id. A stream is repeated only before its first message. `revival` must be
  // thread-safe.
  explicit Client(const std::shared_ptr<grpc::ChannelInterface>& channel,
                  absl::Duration timeout = kCallTimeout, Revival revival = {});

  // Returns the new job, or an earlier job with the same specification. In the second case
  // answered_from_store is set; no other call sets it.
  absl::StatusOr<v1::EnsembleJob> Create(const v1::CreateEnsembleJobRequest& request) const;
  absl::StatusOr<v1::EnsembleJob> Create(const v1::EnsembleSpec& spec) const;

  // The cost and the accuracy of each model. Runs nothing.
  absl::StatusOr<v1::PlanEnsembleJobResponse> Plan(const v1::EnsembleSpec& spec) const;

  absl::StatusOr<v1::EnsembleJob> Get(const std::string& name) const;
  // At most `most` jobs, newest first. Fetches as many pages as needed and ignores the request's
  // page fields.
  static constexpr int64_t kAllJobs = std::numeric_limits<int64_t>::max();
  absl::StatusOr<std::vector<v1::EnsembleJob>> List(v1::ListEnsembleJobsRequest request = {},
                                                    int64_t most = kAllJobs) const;
  absl::StatusOr<v1::EnsembleJob> Cancel(const std::string& name) const;
  // The results of a pinned job do not expire. With `pinned` false they may expire again.
  //   FAILED_PRECONDITION  RESULTS_EXPIRED
  absl::StatusOr<v1::EnsembleJob> Pin(const std::string& name, bool pinned) const;
  // Replaces the job's labels.
  absl::StatusOr<v1::EnsembleJob> SetLabels(const std::string& name,
                                            const std::map<std::string, std::string>& labels) const;
  // Not repeated: after a successful first attempt the second would report NOT_FOUND.
  absl::Status Delete(const std::string& name) const;

  // The finished points in grid order, page by page, so that a large result need not fit into
  // memory. `page_token`: empty for the first page, else next_page_token of the page before.
  //
  // FAILED_PRECONDITION (RESULTS_EXPIRED) if the server keeps only the specification. Create with
  // this specification then computes the same results again.
  absl::StatusOr<v1::ListResultsResponse> ResultsPage(const std::string& name,
                                                      v1::ListResultsRequest::View view,
                                                      const std::string& page_token) const;
  // All pages.
  absl::StatusOr<std::vector<v1::PointResult>> Results(
      const std::string& name,
      v1::ListResultsRequest::View view = v1::ListResultsRequest::FULL) const;
  // One point, with histograms and curves. `index`: its position in the grid, from 0.
  //   NOT_FOUND  RESULT_NOT_FOUND: the point is not finished yet, or not in the grid
  absl::StatusOr<v1::PointResult> Point(const std::string& name, int64_t index) const;

  absl::StatusOr<v1::EvaluatePairsResponse> EvaluatePairs(
      const v1::EvaluatePairsRequest& request) const;

  // Calls `on_message` with the start and the events of one orbit, message by message, until the
  // trace ends or `on_message` returns false. Returns OK in both cases.
  using TraceCallback = std::function<bool(const v1::TraceOrbitResponse&)>;
  absl::Status Trace(const v1::TraceOrbitRequest& request, const TraceCallback& on_message) const;

  // The same with the collisions of a point's samples: the specification has one point.
  using CollisionsCallback = std::function<bool(const v1::SampleCollisionsResponse&)>;
  absl::Status Sample(const v1::EnsembleSpec& spec, const CollisionsCallback& on_message) const;

  // The first call takes nearly a second, because the server measures its speed.
  absl::StatusOr<v1::ServerStatus> Status() const;

  // Follows the job to its end (job_watch.h), and returns the ended job, without its grid.
  // CANCELLED if `stop` was requested (the job continues), UNAVAILABLE if the watch gave up
  // (RESOURCE_EXHAUSTED if the server was busy), else the server's error. A stop ends the watch at
  // once; if `revival` is running, after it returns.
  absl::StatusOr<v1::EnsembleJob> Watch(const std::string& name, const WatchCallbacks& callbacks,
                                        const WatchOptions& options = {},
                                        std::stop_token stop = {}) const;

  // Any call of the API; the type of `request`, a request message, decides its method. Every call
  // of this class uses it. If the request has an empty field for an idempotency key, adds one, so
  // that a retry returns the original job. Reads each answer into `answer` and calls `on_answer`;
  // if it returns false, the call ends with the status OK. CANCELLED if `stop` was requested. The
  // call ends at once, or after a delay that the server asked for, or after `revival` returns.
  absl::Status Call(const google::protobuf::Message& request, google::protobuf::Message& answer,
                    const std::function<bool()>& on_answer, absl::Duration timeout,
                    const std::stop_token& stop = {}) const;

 private:
  // A call with one answer.
  template <typename Answer>
  absl::StatusOr<Answer> Ask(const google::protobuf::Message& request) const;

  std::shared_ptr<grpc::ChannelInterface> channel_;
  absl::Duration timeout_;
  Revival revival_;
};

}  // namespace ballpiston::client
