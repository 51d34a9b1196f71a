#include "tests/server/call_by_name.h"

namespace ballpiston::server {

NamedCall::NamedCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                     const std::vector<std::string>& authorization)
    : stub_(channel) {
  context_.set_deadline(std::chrono::system_clock::now() + kPatience);
  for (const std::string& value : authorization) context_.AddMetadata("authorization", value);
  call_ = stub_.PrepareCall(&context_, method, &queue_);
  call_->StartCall(nullptr);
  started_ = Next();
}

NamedCall::~NamedCall() {
  context_.TryCancel();
  Finish();
}

void NamedCall::Send(const std::string& bytes) {
  if (!started_) return;
  const grpc::Slice slice(bytes);
  call_->WriteLast(grpc::ByteBuffer(&slice, 1), {}, nullptr);
  Next();
}

void NamedCall::AwaitAnswer() {
  call_->ReadInitialMetadata(nullptr);
  Next();
}

std::optional<std::string> NamedCall::Read() {
  grpc::ByteBuffer answer;
  call_->Read(&answer, nullptr);
  grpc::Slice slice;
  if (!Next() || !answer.DumpToSingleSlice(&slice).ok()) return std::nullopt;
  return std::string(slice.begin(), slice.end());
}

grpc::Status NamedCall::Finish() {
  if (!status_) {
    call_->Finish(&status_.emplace(), nullptr);
    Next();
  }
  return *status_;
}

bool NamedCall::Next() {
  void* tag = nullptr;
  bool ok = false;
  return queue_.Next(&tag, &ok) && ok;
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
