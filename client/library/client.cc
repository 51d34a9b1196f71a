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
absl::Status CallOnce(Stub& stub,
                      grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                      const Request& request, absl::Duration timeout, Response& response) {
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + timeout));
  return FromGrpc((stub.*method)(&context, request, &response));
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

}  // namespace

bool Client::IsBack(absl::Status& status) const {
  if (!revival_ || !absl::IsUnavailable(status)) return false;
  absl::SleepFor(RetryDelay(status));
  const absl::Status revived = revival_();
  if (!revived.ok()) status = revived;
  return revived.ok();
}

template <typename Stub, typename Request, typename Response>
absl::StatusOr<Response> Client::Ask(Stub& stub,
                                     grpc::Status (Stub::*method)(grpc::ClientContext*,
                                                                  const Request&, Response*),
                                     const Request& request) const {
  Response response;
  absl::Status status = CallOnce(stub, method, request, timeout_, response);
  if (IsBack(status)) status = CallOnce(stub, method, request, timeout_, response);
  if (!status.ok()) return status;
  return response;
}

// Reads until the stream ends or `on_message` returns false. In the second case the call is
// cancelled, and the status is OK.
template <typename Message, typename Open>
absl::Status Client::Read(const Open& open,
                          const std::function<bool(const Message&)>& on_message) const {
  bool has_begun = false;
  const auto read = [&] {
    grpc::ClientContext context;
    const auto reader = open(&context);
    Message message;
    bool is_wanted = true;
    while (is_wanted && reader->Read(&message)) {
      has_begun = true;
      is_wanted = on_message(message);
    }
    if (!is_wanted) context.TryCancel();
    const absl::Status end = FromGrpc(reader->Finish());
    return is_wanted ? end : absl::OkStatus();
  };
  absl::Status status = read();
  if (!has_begun && IsBack(status)) status = read();
  return status;
}

Client::Client(const std::shared_ptr<grpc::ChannelInterface>& channel, absl::Duration timeout,
               Revival revival)
    : channel_(channel),
      ensembles_(v1::EnsembleService::NewStub(channel)),
      analytic_(v1::AnalyticService::NewStub(channel)),
      trace_(v1::TraceService::NewStub(channel)),
      server_(v1::ServerService::NewStub(channel)),
      timeout_(timeout),
      revival_(std::move(revival)) {}

absl::StatusOr<v1::EnsembleJob> Client::Create(const v1::EnsembleSpec& spec,
                                               const CreateOptions& options) const {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  request.set_request_id(options.request_id.empty() ? NewRequestId() : options.request_id);
  request.set_fresh(options.fresh);
  request.set_priority(options.priority);
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  return Ask(*ensembles_, &Stub::CreateEnsembleJob, request);
}

absl::StatusOr<v1::PlanEnsembleJobResponse> Client::Plan(const v1::EnsembleSpec& spec) const {
  v1::PlanEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  return Ask(*ensembles_, &Stub::PlanEnsembleJob, request);
}

absl::StatusOr<v1::EnsembleJob> Client::Get(const std::string& name) const {
  v1::GetEnsembleJobRequest request;
  request.set_name(name);
  return Ask(*ensembles_, &Stub::GetEnsembleJob, request);
}

absl::StatusOr<std::vector<v1::EnsembleJob>> Client::List(v1::ListEnsembleJobsRequest request,
                                                          int64_t most) const {
  std::vector<v1::EnsembleJob> jobs;
  request.clear_page_token();
  do {
    const int64_t missing = most - std::ssize(jobs);
    request.set_page_size(static_cast<int32_t>(std::min<int64_t>(kPageSize, missing)));
    auto page = Ask(*ensembles_, &Stub::ListEnsembleJobs, request);
    if (!page.ok()) return page.status();
    for (v1::EnsembleJob& job : *page->mutable_jobs()) jobs.push_back(std::move(job));
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty() && std::ssize(jobs) < most);
  return jobs;
}

absl::StatusOr<v1::EnsembleJob> Client::Cancel(const std::string& name) const {
  v1::CancelEnsembleJobRequest request;
  request.set_name(name);
  request.set_request_id(NewRequestId());
  return Ask(*ensembles_, &Stub::CancelEnsembleJob, request);
}

absl::StatusOr<v1::EnsembleJob> Client::Pin(const std::string& name, bool pinned) const {
  v1::UpdateEnsembleJobRequest request;
  request.mutable_job()->set_name(name);
  request.mutable_job()->set_pinned(pinned);
  request.mutable_update_mask()->add_paths("pinned");
  return Ask(*ensembles_, &Stub::UpdateEnsembleJob, request);
}

absl::StatusOr<v1::EnsembleJob> Client::SetLabels(
    const std::string& name, const std::map<std::string, std::string>& labels) const {
  v1::UpdateEnsembleJobRequest request;
  request.mutable_job()->set_name(name);
  request.mutable_job()->mutable_labels()->insert(labels.begin(), labels.end());
  request.mutable_update_mask()->add_paths("labels");
  return Ask(*ensembles_, &Stub::UpdateEnsembleJob, request);
}

absl::Status Client::Delete(const std::string& name) const {
  v1::DeleteEnsembleJobRequest request;
  request.set_name(name);
  google::protobuf::Empty nothing;
  return CallOnce(*ensembles_, &Stub::DeleteEnsembleJob, request, timeout_, nothing);
}

absl::StatusOr<v1::ListResultsResponse> Client::ResultsPage(const std::string& name,
                                                            v1::ListResultsRequest::View view,
                                                            const std::string& page_token) const {
  v1::ListResultsRequest request;
  request.set_parent(name);
  request.set_page_size(kPageSize);
  request.set_page_token(page_token);
  request.set_view(view);
  return Ask(*ensembles_, &Stub::ListResults, request);
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
  return Ask(*ensembles_, &Stub::GetResult, request);
}

absl::StatusOr<v1::EvaluatePairsResponse> Client::EvaluatePairs(
    const v1::EvaluatePairsRequest& request) const {
  return Ask(*analytic_, &v1::AnalyticService::StubInterface::EvaluatePairs, request);
}

absl::Status Client::Trace(const v1::TraceOrbitRequest& request,
                           const TraceCallback& on_message) const {
  return Read<v1::TraceOrbitResponse>(
      [&](grpc::ClientContext* context) { return trace_->TraceOrbit(context, request); },
      on_message);
}

absl::Status Client::Sample(const v1::EnsembleSpec& spec,
                            const CollisionsCallback& on_message) const {
  v1::SampleCollisionsRequest request;
  *request.mutable_spec() = spec;
  return Read<v1::SampleCollisionsResponse>(
      [&](grpc::ClientContext* context) { return trace_->SampleCollisions(context, request); },
      on_message);
}

absl::StatusOr<v1::ServerStatus> Client::Status() const {
  return Ask(*server_, &v1::ServerService::StubInterface::GetServerStatus,
             v1::GetServerStatusRequest());
}

absl::StatusOr<v1::EnsembleJob> Client::Watch(const std::string& name,
                                              const WatchCallbacks& callbacks,
                                              const WatchOptions& options,
                                              std::stop_token stop) const {
  return WatchJob(*ensembles_, name, callbacks, options, stop, [&] {
    if (revival_) revival_().IgnoreError();  // the next attempt reports that there is no server
    AwaitConnection(*channel_, stop);
  });
}

}  // namespace ballpiston::client
