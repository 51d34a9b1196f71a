#include "client/web/json_call.h"

#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

#include <memory>

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "client/library/quoted.h"
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

absl::Status CallWithJson(const Client& client, const JsonCall& call, const JsonReceiver& receive) {
  const absl::StatusOr<std::unique_ptr<Message>> request = RequestOf(call);
  if (!request.ok()) return request.status();
  const std::unique_ptr<Message> answer = New(call.method->output_type());
  const auto on_answer = [&] { return receive(Json(*answer)); };
  return client.Call(**request, *answer, on_answer, call.timeout);
}

}  // namespace ballpiston::client
