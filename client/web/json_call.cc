#include "client/web/json_call.h"

#include <google/protobuf/message.h>

#include <memory>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "client/output/json.h"

namespace ballpiston::client {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::Message;
using google::protobuf::MessageFactory;

std::unique_ptr<Message> New(const Descriptor* type) {
  return std::unique_ptr<Message>(MessageFactory::generated_factory()->GetPrototype(type)->New());
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

absl::Status CallWithJson(const Client& client, const google::protobuf::MethodDescriptor& method,
                          const std::string& json, absl::Duration timeout,
                          const JsonReceiver& receive) {
  const Descriptor* const type = method.input_type();
  const std::unique_ptr<Message> request = New(type);
  const absl::Status bad = ReadJson(json.empty() ? "{}" : json, *request);
  if (!bad.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("the request is not JSON of ", type->full_name(), ": ", bad.message()));
  }
  const std::unique_ptr<Message> answer = New(method.output_type());
  const auto on_answer = [&] { return receive(Json(*answer)); };
  return client.Call(*request, *answer, on_answer, timeout);
}

}  // namespace ballpiston::client
