#include "tests/server/call_by_name.h"

namespace ballpiston::server {

using grpc::ByteBuffer;
using grpc::internal::RpcMethod;

std::string PathOf(const google::protobuf::MethodDescriptor& method) {
  return "/" + method.service()->full_name() + "/" + method.name();
}

std::string PathOf(const google::protobuf::Descriptor& request) {
  const google::protobuf::ServiceDescriptor& service = *request.file()->service(0);
  for (int i = 0; i < service.method_count(); ++i) {
    if (service.method(i)->input_type() == &request) return PathOf(*service.method(i));
  }
  ADD_FAILURE() << "no method takes a " << request.full_name();
  return "";
}

// A unary method is called as a stream of one message.
NamedCall::NamedCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                     const std::vector<std::string>& authorization) {
  context_.set_deadline(std::chrono::system_clock::now() + kPatience);
  for (const std::string& value : authorization) context_.AddMetadata("authorization", value);
  stream_.reset(grpc::internal::ClientReaderWriterFactory<ByteBuffer, ByteBuffer>::Create(
      channel.get(), RpcMethod(method.c_str(), RpcMethod::BIDI_STREAMING), &context_));
}

NamedCall::~NamedCall() {
  context_.TryCancel();
  Finish();
}

void NamedCall::Send(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  stream_->WriteLast(ByteBuffer(&slice, 1), {});
}

std::optional<std::string> NamedCall::Read() {
  ByteBuffer answer;
  grpc::Slice slice;
  if (!stream_->Read(&answer) || !answer.DumpToSingleSlice(&slice).ok()) return std::nullopt;
  return std::string(slice.begin(), slice.end());
}

grpc::Status NamedCall::Finish() {
  if (!status_) status_ = stream_->Finish();
  return *status_;
}

grpc::Status CallByName(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                        const std::string& bytes, const std::vector<std::string>& authorization,
                        std::string* answer) {
  NamedCall call(channel, method, authorization);
  call.Send(bytes);
  // Reads also after a failed write. If the server closes the connection before it has begun the
  // call, gRPC 1.51 reports a failed write, and then sends the whole call again on another
  // connection. Finish does not return before the answer to that has been read.
  while (const auto message = call.Read()) {
    if (answer != nullptr) *answer = *message;
  }
  return call.Finish();
}

std::vector<std::string> Bearer(const std::string& token) {
  if (token.empty()) return {};
  return {"Bearer " + token};
}

}  // namespace ballpiston::server
