#include "client/library/client.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/sync_stream.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/library/error_text.h"
#include "client/library/request_id.h"

namespace ballpiston::client {
namespace {

using google::protobuf::Message;

constexpr int kPageSize = 1000;

// The only method that takes this message. Each .proto file has one service.
const google::protobuf::MethodDescriptor& MethodOf(const Message& request) {
  const google::protobuf::ServiceDescriptor& service = *request.GetDescriptor()->file()->service(0);
  int i = 0;
  while (service.method(i)->input_type() != request.GetDescriptor()) ++i;
  return *service.method(i);
}

// A copy, with an id if it has an empty field for it.
std::unique_ptr<Message> WithRequestId(const Message& request) {
  std::unique_ptr<Message> copy(request.New());
  copy->CopyFrom(request);
  const auto* const field = request.GetDescriptor()->FindFieldByName("request_id");
  const google::protobuf::Reflection& values = *request.GetReflection();
  if (field != nullptr && values.GetString(*copy, field).empty()) {
    values.SetString(copy.get(), field, NewRequestId());
  }
  return copy;
}

}  // namespace

absl::Status Client::Call(const Message& request, Message& answer,
                          const std::function<bool()>& on_answer, absl::Duration timeout,
                          const std::stop_token& stop) const {
  const google::protobuf::MethodDescriptor& called = MethodOf(request);
  const std::string path = absl::StrCat("/", called.service()->full_name(), "/", called.name());
  // This is how the generated stubs of gRPC call a method. A method with a single answer is called
  // as a stream of one message.
  const grpc::internal::RpcMethod method(path.c_str(), grpc::internal::RpcMethod::SERVER_STREAMING);
  const std::unique_ptr<Message> sent = WithRequestId(request);
  bool has_begun = false;
  const auto attempt = [&] {
    grpc::ClientContext context;
    const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
    if (timeout < absl::InfiniteDuration()) {
      context.set_deadline(absl::ToChronoTime(absl::Now() + timeout));
    }
    const std::unique_ptr<grpc::ClientReader<Message>> reader(
        grpc::internal::ClientReaderFactory<Message>::Create(channel_.get(), method, &context,
                                                             *sent));
    bool is_wanted = true;
    while (is_wanted && reader->Read(&answer)) {
      has_begun = true;
      is_wanted = on_answer();
    }
    if (!is_wanted) context.TryCancel();
    const absl::Status end = FromGrpc(reader->Finish());
    if (!is_wanted) return absl::OkStatus();
    if (!end.ok() || has_begun || called.server_streaming()) return end;
    return absl::InternalError("the server's answer cannot be parsed");
  };
  absl::Status status = attempt();
  const bool may_repeat =
      !has_begun && request.GetDescriptor() != v1::DeleteEnsembleJobRequest::descriptor();
  if (!may_repeat || !revival_ || !absl::IsUnavailable(status)) return status;
  absl::SleepFor(RetryDelay(status));
  if (absl::Status revived = revival_(); !revived.ok()) return revived;
  return attempt();
}

template <typename Answer>
absl::StatusOr<Answer> Client::Ask(const Message& request) const {
  Answer answer;
  const auto on_answer = [] { return true; };
  const absl::Status status = Call(request, answer, on_answer, timeout_);
  if (!status.ok()) return status;
  return answer;
}

Client::Client(const std::shared_ptr<grpc::ChannelInterface>& channel, absl::Duration timeout,
               Revival revival)
    : channel_(channel), timeout_(timeout), revival_(std::move(revival)) {}

absl::StatusOr<v1::EnsembleJob> Client::Create(const v1::CreateEnsembleJobRequest& request) const {
  return Ask<v1::EnsembleJob>(request);
}

absl::StatusOr<v1::EnsembleJob> Client::Create(const v1::EnsembleSpec& spec) const {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  return Create(request);
}

absl::StatusOr<v1::PlanEnsembleJobResponse> Client::Plan(const v1::EnsembleSpec& spec) const {
  v1::PlanEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  return Ask<v1::PlanEnsembleJobResponse>(request);
}

absl::StatusOr<v1::EnsembleJob> Client::Get(const std::string& name) const {
  v1::GetEnsembleJobRequest request;
  request.set_name(name);
  return Ask<v1::EnsembleJob>(request);
}

absl::StatusOr<std::vector<v1::EnsembleJob>> Client::List(v1::ListEnsembleJobsRequest request,
                                                          int64_t most) const {
  std::vector<v1::EnsembleJob> jobs;
  if (most <= 0) return jobs;
  request.clear_page_token();
  do {
    const int64_t missing = most - std::ssize(jobs);
    request.set_page_size(static_cast<int32_t>(std::min<int64_t>(kPageSize, missing)));
    auto page = Ask<v1::ListEnsembleJobsResponse>(request);
    if (!page.ok()) return page.status();
    for (v1::EnsembleJob& job : *page->mutable_jobs()) jobs.push_back(std::move(job));
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty() && std::ssize(jobs) < most);
  return jobs;
}

absl::StatusOr<v1::EnsembleJob> Client::Cancel(const std::string& name) const {
  v1::CancelEnsembleJobRequest request;
  request.set_name(name);
  return Ask<v1::EnsembleJob>(request);
}

absl::StatusOr<v1::EnsembleJob> Client::Pin(const std::string& name, bool pinned) const {
  v1::UpdateEnsembleJobRequest request;
  request.mutable_job()->set_name(name);
  request.mutable_job()->set_pinned(pinned);
  request.mutable_update_mask()->add_paths("pinned");
  return Ask<v1::EnsembleJob>(request);
}

absl::StatusOr<v1::EnsembleJob> Client::SetLabels(
    const std::string& name, const std::map<std::string, std::string>& labels) const {
  v1::UpdateEnsembleJobRequest request;
  request.mutable_job()->set_name(name);
  request.mutable_job()->mutable_labels()->insert(labels.begin(), labels.end());
  request.mutable_update_mask()->add_paths("labels");
  return Ask<v1::EnsembleJob>(request);
}

absl::Status Client::Delete(const std::string& name) const {
  v1::DeleteEnsembleJobRequest request;
  request.set_name(name);
  return Ask<google::protobuf::Empty>(request).status();
}

absl::StatusOr<v1::ListResultsResponse> Client::ResultsPage(const std::string& name,
                                                            v1::ListResultsRequest::View view,
                                                            const std::string& page_token) const {
  v1::ListResultsRequest request;
  request.set_parent(name);
  request.set_page_size(kPageSize);
  request.set_page_token(page_token);
  request.set_view(view);
  return Ask<v1::ListResultsResponse>(request);
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
  return Ask<v1::PointResult>(request);
}

absl::StatusOr<v1::EvaluatePairsResponse> Client::EvaluatePairs(
    const v1::EvaluatePairsRequest& request) const {
  return Ask<v1::EvaluatePairsResponse>(request);
}

absl::Status Client::Trace(const v1::TraceOrbitRequest& request,
                           const TraceCallback& on_message) const {
  v1::TraceOrbitResponse message;
  const auto receive = [&] { return on_message(message); };
  return Call(request, message, receive, absl::InfiniteDuration());
}

absl::Status Client::Sample(const v1::EnsembleSpec& spec,
                            const CollisionsCallback& on_message) const {
  v1::SampleCollisionsRequest request;
  *request.mutable_spec() = spec;
  v1::SampleCollisionsResponse message;
  const auto receive = [&] { return on_message(message); };
  return Call(request, message, receive, absl::InfiniteDuration());
}

absl::StatusOr<v1::ServerStatus> Client::Status() const {
  return Ask<v1::ServerStatus>(v1::GetServerStatusRequest());
}

}  // namespace ballpiston::client
