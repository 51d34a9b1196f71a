#include "client/web/connect_protocol.h"

#include <google/protobuf/message.h>
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "client/library/error_text.h"
#include "client/output/json.h"

namespace ballpiston::client {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::ListValue;
using google::protobuf::Message;
using google::protobuf::Struct;

constexpr size_t kPrefix = 5;  // flags and length
constexpr char kEndFlag = 2;

std::string CodeName(absl::StatusCode code) {
  if (code == absl::StatusCode::kCancelled) return "canceled";  // the protocol spells it with one l
  return absl::AsciiStrToLower(absl::StatusCodeToString(code));
}

Struct DetailOf(const google::protobuf::Any& any) {
  Struct detail;
  auto& fields = *detail.mutable_fields();
  fields["type"].set_string_value(
      std::string(absl::StripPrefix(any.type_url(), "type.googleapis.com/")));
  std::string value = absl::Base64Escape(any.value());
  value.erase(value.find_last_not_of('=') + 1);  // the protocol omits the padding
  fields["value"].set_string_value(value);
  Struct debug;
  const auto status = google::protobuf::util::JsonStringToMessage(Json(any), &debug);
  if (status.ok()) *fields["debug"].mutable_struct_value() = std::move(debug);
  return detail;
}

Struct ErrorOf(const absl::Status& status) {
  Struct error;
  auto& fields = *error.mutable_fields();
  fields["code"].set_string_value(CodeName(status.code()));
  fields["message"].set_string_value(std::string(status.message()));
  const google::rpc::Status attached = ErrorDetails(status);
  if (attached.details().empty()) return error;
  ListValue& details = *fields["details"].mutable_list_value();
  for (const google::protobuf::Any& any : attached.details()) {
    *details.add_values()->mutable_struct_value() = DetailOf(any);
  }
  return error;
}

std::string FlaggedEnvelope(char flags, absl::string_view message) {
  std::string envelope(1, flags);
  const auto length = static_cast<uint32_t>(message.size());
  for (int shift = 24; shift >= 0; shift -= 8) {
    envelope.push_back(static_cast<char>(length >> shift & 0xff));
  }
  return absl::StrCat(envelope, message);
}

std::unique_ptr<Message> New(const Descriptor* type) {
  return std::unique_ptr<Message>(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(type)->New());
}

}  // namespace

int HttpStatus(absl::StatusCode code) {
  using Code = absl::StatusCode;
  static const auto* const table = new std::map<Code, int>{
      {Code::kOk, 200},          {Code::kInvalidArgument, 400},   {Code::kFailedPrecondition, 400},
      {Code::kOutOfRange, 400},  {Code::kUnauthenticated, 401},   {Code::kPermissionDenied, 403},
      {Code::kNotFound, 404},    {Code::kAborted, 409},           {Code::kAlreadyExists, 409},
      {Code::kCancelled, 499},   {Code::kResourceExhausted, 429}, {Code::kUnimplemented, 501},
      {Code::kUnavailable, 503}, {Code::kDeadlineExceeded, 504}};
  const auto row = table->find(code);
  return row == table->end() ? 500 : row->second;
}

std::string ErrorJson(const absl::Status& status) { return Json(ErrorOf(status)); }

std::string Envelope(absl::string_view message) { return FlaggedEnvelope(0, message); }

std::string EndOfStream(const absl::Status& status) {
  Struct end;
  if (!status.ok()) *(*end.mutable_fields())["error"].mutable_struct_value() = ErrorOf(status);
  return FlaggedEnvelope(kEndFlag, Json(end));
}

absl::StatusOr<std::string> OpenEnvelope(absl::string_view body) {
  if (body.size() >= kPrefix && FlaggedEnvelope(0, body.substr(kPrefix)) == body) {
    return std::string(body.substr(kPrefix));
  }
  return absl::InvalidArgumentError(
      "the request of a stream must be one message in an envelope: a byte 0, the length as 4 "
      "bytes, big-endian, and the JSON");
}

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
