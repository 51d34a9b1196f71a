#include "client/library/client.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/library/error_text.h"
#include "client/library/request_id.h"

namespace ballpiston::client {
namespace {

using Stub = v1::EnsembleService::StubInterface;

constexpr int kPageSize = 1000;

// One call with one answer and a deadline. `method` is one of the stub's.
template <typename Stub, typename Request, typename Response>
absl::StatusOr<Response> CallUnary(Stub& stub,
                                   grpc::Status (Stub::*method)(grpc::ClientContext*,
                                                                const Request&, Response*),
                                   const Request& request, absl::Duration timeout) {
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + timeout));
  Response response;
  absl::Status status = FromGrpc((stub.*method)(&context, request, &response));
  if (!status.ok()) return status;
  return response;
}

// gRPC checks only every 5 s whether a channel has reconnected, unless a caller waits for it.
constexpr absl::Duration kLongestConnecting = absl::Seconds(1);
constexpr absl::Duration kLookForStop = absl::Milliseconds(50);

void AwaitConnection(grpc::ChannelInterface& channel, const std::stop_token& stop) {
  const absl::Time limit = absl::Now() + kLongestConnecting;
  while (!stop.stop_requested() && absl::Now() < limit) {
    if (channel.WaitForConnected(absl::ToChronoTime(absl::Now() + kLookForStop))) return;
  }
}

// Until the stream ends or `on_message` returns false; then the call is cancelled, and the status
// is OK.
template <typename Message>
absl::Status ReadStream(grpc::ClientContext& context, grpc::ClientReaderInterface<Message>& reader,
                        const std::function<bool(const Message&)>& on_message) {
  Message message;
  bool is_wanted = true;
  while (is_wanted && reader.Read(&message)) is_wanted = on_message(message);
  if (!is_wanted) context.TryCancel();
  const absl::Status end = FromGrpc(reader.Finish());
  return is_wanted ? end : absl::OkStatus();
}

}  // namespace

Client::Client(const std::shared_ptr<grpc::ChannelInterface>& channel, absl::Duration timeout)
    : channel_(channel),
      ensembles_(v1::EnsembleService::NewStub(channel)),
      analytic_(v1::AnalyticService::NewStub(channel)),
      trace_(v1::TraceService::NewStub(channel)),
      server_(v1::ServerService::NewStub(channel)),
      timeout_(timeout) {}

absl::StatusOr<v1::EnsembleJob> Client::Create(const v1::EnsembleSpec& spec,
                                               const CreateOptions& options) const {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  request.set_request_id(options.request_id.empty() ? NewRequestId() : options.request_id);
  request.set_fresh(options.fresh);
  request.set_priority(options.priority);
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  return CallUnary(*ensembles_, &Stub::CreateEnsembleJob, request, timeout_);
}

absl::StatusOr<v1::PlanEnsembleJobResponse> Client::Plan(const v1::EnsembleSpec& spec) const {
  v1::PlanEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  return CallUnary(*ensembles_, &Stub::PlanEnsembleJob, request, timeout_);
}

absl::StatusOr<v1::EnsembleJob> Client::Get(const std::string& name) const {
  v1::GetEnsembleJobRequest request;
  request.set_name(name);
  return CallUnary(*ensembles_, &Stub::GetEnsembleJob, request, timeout_);
}

absl::StatusOr<std::vector<v1::EnsembleJob>> Client::List(v1::ListEnsembleJobsRequest request,
                                                          int64_t most) const {
  std::vector<v1::EnsembleJob> jobs;
  request.clear_page_token();
  do {
    const int64_t missing = most - std::ssize(jobs);
    request.set_page_size(static_cast<int32_t>(std::min<int64_t>(kPageSize, missing)));
    auto page = CallUnary(*ensembles_, &Stub::ListEnsembleJobs, request, timeout_);
    if (!page.ok()) return page.status();
    for (v1::EnsembleJob& job : *page->mutable_jobs()) jobs.push_back(std::move(job));
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty() && std::ssize(jobs) < most);
  return jobs;
}

absl::StatusOr<v1::EnsembleJob> Client::Cancel(const std::string& name,
                                               const std::string& request_id) const {
  v1::CancelEnsembleJobRequest request;
  request.set_name(name);
  request.set_request_id(request_id.empty() ? NewRequestId() : request_id);
  return CallUnary(*ensembles_, &Stub::CancelEnsembleJob, request, timeout_);
}

absl::StatusOr<v1::EnsembleJob> Client::Pin(const std::string& name, bool pinned) const {
  v1::UpdateEnsembleJobRequest request;
  request.mutable_job()->set_name(name);
  request.mutable_job()->set_pinned(pinned);
  request.mutable_update_mask()->add_paths("pinned");
  return CallUnary(*ensembles_, &Stub::UpdateEnsembleJob, request, timeout_);
}

absl::StatusOr<v1::EnsembleJob> Client::SetLabels(
    const std::string& name, const std::map<std::string, std::string>& labels) const {
  v1::UpdateEnsembleJobRequest request;
  request.mutable_job()->set_name(name);
  request.mutable_job()->mutable_labels()->insert(labels.begin(), labels.end());
  request.mutable_update_mask()->add_paths("labels");
  return CallUnary(*ensembles_, &Stub::UpdateEnsembleJob, request, timeout_);
}

absl::Status Client::Delete(const std::string& name) const {
  v1::DeleteEnsembleJobRequest request;
  request.set_name(name);
  return CallUnary(*ensembles_, &Stub::DeleteEnsembleJob, request, timeout_).status();
}

absl::StatusOr<v1::ListResultsResponse> Client::ResultsPage(const std::string& name,
                                                            v1::ListResultsRequest::View view,
                                                            const std::string& page_token) const {
  v1::ListResultsRequest request;
  request.set_parent(name);
  request.set_page_size(kPageSize);
  request.set_page_token(page_token);
  request.set_view(view);
  return CallUnary(*ensembles_, &Stub::ListResults, request, timeout_);
}

absl::StatusOr<std::vector<v1::PointResult>> Client::Results(
    const std::string& name, v1::ListResultsRequest::View view) const {
  std::vector<v1::PointResult> points;
  std::string token;
  do {
    const auto page = ResultsPage(name, view, token);
    if (!page.ok()) return page.status();
    points.insert(points.end(), page->results().begin(), page->results().end());
    token = page->next_page_token();
  } while (!token.empty());
  return points;
}

absl::StatusOr<v1::PointResult> Client::Point(const std::string& name, int64_t index) const {
  v1::GetResultRequest request;
  request.set_name(absl::StrCat(name, "/results/", index));
  return CallUnary(*ensembles_, &Stub::GetResult, request, timeout_);
}

absl::StatusOr<v1::EvaluatePairsResponse> Client::EvaluatePairs(
    const v1::EvaluatePairsRequest& request) const {
  return CallUnary(*analytic_, &v1::AnalyticService::StubInterface::EvaluatePairs, request,
                   timeout_);
}

absl::Status Client::Trace(const v1::TraceOrbitRequest& request,
                           const TraceCallback& on_message) const {
  grpc::ClientContext context;
  return ReadStream<v1::TraceOrbitResponse>(context, *trace_->TraceOrbit(&context, request),
                                            on_message);
}

absl::Status Client::Sample(const v1::EnsembleSpec& spec,
                            const CollisionsCallback& on_message) const {
  grpc::ClientContext context;
  v1::SampleCollisionsRequest request;
  *request.mutable_spec() = spec;
  return ReadStream<v1::SampleCollisionsResponse>(
      context, *trace_->SampleCollisions(&context, request), on_message);
}

absl::StatusOr<v1::ServerStatus> Client::Status() const {
  return CallUnary(*server_, &v1::ServerService::StubInterface::GetServerStatus,
                   v1::GetServerStatusRequest(), timeout_);
}

absl::StatusOr<v1::EnsembleJob> Client::Watch(const std::string& name,
                                              const WatchCallbacks& callbacks,
                                              const WatchOptions& options,
                                              std::stop_token stop) const {
  WatchOptions connecting = options;
  connecting.before_reattach = [&] {
    if (options.before_reattach) options.before_reattach();
    AwaitConnection(*channel_, stop);
  };
  return WatchJob(*ensembles_, name, callbacks, connecting, stop);
}

}  // namespace ballpiston::client
