#include "client/web/json_call.h"

#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/sync_stream.h>

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/time/clock.h"
#include "client/library/error_text.h"
#include "client/library/quoted.h"
#include "client/library/request_id.h"
#include "client/output/json.h"

namespace ballpiston::client {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::Message;
using google::protobuf::MessageFactory;

std::unique_ptr<Message> New(const Descriptor* type) {
  return std::unique_ptr<Message>(MessageFactory::generated_factory()->GetPrototype(type)->New());
}

absl::StatusOr<std::unique_ptr<Message>> RequestOf(const JsonCall& call) {
  const Descriptor* type = call.method->input_type();
  const auto bad = [type](absl::string_view reason) {
    return absl::InvalidArgumentError(
        absl::StrCat("the request is not JSON of ", type->full_name(), ": ", reason));
  };
  const std::string json = call.request.empty() ? "{}" : call.request;
  // The parser accepts `null` and a bare string as an empty message.
  if (!absl::StartsWith(absl::StripLeadingAsciiWhitespace(json), "{")) return bad("not an object");
  std::unique_ptr<Message> request = New(type);
  const auto status = google::protobuf::util::JsonStringToMessage(json, request.get());
  // The parser's message contains the wrong value in full, even if it is very long.
  if (!status.ok()) return bad(Shortened(std::string(status.message()), kLongestMessage));
  return request;
}

}  // namespace

const google::protobuf::MethodDescriptor* FindMethod(absl::string_view path) {
  const auto* method = google::protobuf::DescriptorPool::generated_pool()->FindMethodByName(
      absl::StrReplaceAll(path, {{"/", "."}}));
  if (method == nullptr || method->client_streaming()) return nullptr;
  const bool is_spelled_so =
      path == absl::StrCat(method->service()->full_name(), "/", method->name());
  return is_spelled_so && absl::StartsWith(path, "ballpiston.v1.") ? method : nullptr;
}

JsonCall WithRequestId(JsonCall call) {
  const std::unique_ptr<Message> request = New(call.method->input_type());
  const auto* const field = call.method->input_type()->FindFieldByName("request_id");
  const auto status = google::protobuf::util::JsonStringToMessage(call.request, request.get());
  if (field == nullptr || !status.ok()) return call;
  const auto* const reflection = request->GetReflection();
  if (!reflection->GetString(*request, field).empty()) return call;
  reflection->SetString(request.get(), field, NewRequestId());
  call.request = Json(*request);
  return call;
}

absl::Status CallWithJson(const std::shared_ptr<grpc::Channel>& channel, const JsonCall& call,
                          const JsonReceiver& receive) {
  const absl::StatusOr<std::unique_ptr<Message>> request = RequestOf(call);
  if (!request.ok()) return request.status();
  grpc::ClientContext context;
  if (call.timeout < absl::InfiniteDuration()) {
    context.set_deadline(absl::ToChronoTime(absl::Now() + call.timeout));
  }
  const std::string path =
      absl::StrCat("/", call.method->service()->full_name(), "/", call.method->name());
  // This is how the generated stubs of gRPC call a method. A method with a single answer is called
  // as a stream of one message.
  const grpc::internal::RpcMethod method(path.c_str(), grpc::internal::RpcMethod::SERVER_STREAMING);
  const std::unique_ptr<grpc::ClientReader<Message>> reader(
      grpc::internal::ClientReaderFactory<Message>::Create(channel.get(), method, &context,
                                                           **request));
  const std::unique_ptr<Message> answer = New(call.method->output_type());
  bool is_wanted = true;
  while (is_wanted && reader->Read(answer.get())) is_wanted = receive(Json(*answer));
  if (!is_wanted) context.TryCancel();
  const absl::Status end = FromGrpc(reader->Finish());
  return is_wanted ? end : absl::OkStatus();
}

}  // namespace ballpiston::client
