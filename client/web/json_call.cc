#include "client/web/json_call.h"

#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/proto_buffer_reader.h>

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

absl::StatusOr<grpc::ByteBuffer> RequestBytes(const JsonCall& call) {
  const Descriptor* type = call.method->input_type();
  const auto bad = [type](absl::string_view reason) {
    return absl::InvalidArgumentError(
        absl::StrCat("the request is not JSON of ", type->full_name(), ": ", reason));
  };
  const std::string json = call.request.empty() ? "{}" : call.request;
  // The parser accepts `null` and a bare string as an empty message.
  if (!absl::StartsWith(absl::StripLeadingAsciiWhitespace(json), "{")) return bad("not an object");
  const std::unique_ptr<Message> request = New(type);
  const auto status = google::protobuf::util::JsonStringToMessage(json, request.get());
  // The parser's message contains the wrong value in full, even if it is very long.
  if (!status.ok()) return bad(Shortened(std::string(status.message()), kLongestMessage));
  const grpc::Slice slice(request->SerializeAsString());
  return grpc::ByteBuffer(&slice, 1);
}

absl::StatusOr<std::string> AnswerJson(const Descriptor* type, grpc::ByteBuffer& bytes) {
  const std::unique_ptr<Message> answer = New(type);
  grpc::ProtoBufferReader reader(&bytes);
  if (answer->ParseFromZeroCopyStream(&reader)) return Json(*answer);
  return absl::InternalError(absl::StrCat("the answer is not a ", type->full_name()));
}

// One call with one operation at a time. A method with a single answer is a stream of one message.
class BlockingCall {
 public:
  BlockingCall(const std::shared_ptr<grpc::Channel>& channel, const JsonCall& call) {
    if (call.timeout < absl::InfiniteDuration()) {
      context_.set_deadline(absl::ToChronoTime(absl::Now() + call.timeout));
    }
    const std::string path =
        absl::StrCat("/", call.method->service()->full_name(), "/", call.method->name());
    call_ = grpc::GenericStub(channel).PrepareCall(&context_, path, &queue_);
  }

  ~BlockingCall() {
    queue_.Shutdown();
    Wait();
  }

  bool Send(const grpc::ByteBuffer& request) {
    call_->StartCall(nullptr);
    if (!Wait()) return false;
    call_->WriteLast(request, grpc::WriteOptions(), nullptr);
    return Wait();
  }

  bool Receive(grpc::ByteBuffer& answer) {
    call_->Read(&answer, nullptr);
    return Wait();
  }

  grpc::Status Finish() {
    grpc::Status status;
    call_->Finish(&status, nullptr);
    Wait();
    return status;
  }

  void Cancel() { context_.TryCancel(); }

 private:
  // Waits until the current operation ends.
  bool Wait() {
    void* tag = nullptr;
    bool done = false;
    return queue_.Next(&tag, &done) && done;
  }

  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
};

// Cancels the call. `status` is OK if the receiver wants no more answers.
absl::Status End(BlockingCall& call, const absl::Status& status) {
  call.Cancel();
  call.Finish();
  return status;
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

absl::Status CallWithJson(const std::shared_ptr<grpc::Channel>& channel, const JsonCall& json_call,
                          const JsonReceiver& receive) {
  const absl::StatusOr<grpc::ByteBuffer> request = RequestBytes(json_call);
  if (!request.ok()) return request.status();
  BlockingCall call(channel, json_call);
  grpc::ByteBuffer bytes;
  for (bool more = call.Send(*request) && call.Receive(bytes); more; more = call.Receive(bytes)) {
    const absl::StatusOr<std::string> answer = AnswerJson(json_call.method->output_type(), bytes);
    if (!answer.ok()) return End(call, answer.status());
    if (!receive(*answer)) return End(call, absl::OkStatus());
  }
  return FromGrpc(call.Finish());
}

}  // namespace ballpiston::client
