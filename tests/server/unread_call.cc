#include "tests/server/unread_call.h"

#include <chrono>
#include <utility>

#include "tests/support/await.h"

namespace ballpiston::server {

UnreadCall::UnreadCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method)
    : stub_(channel) {
  context_.set_deadline(std::chrono::system_clock::now() + kPatience);
  call_ = stub_.PrepareCall(&context_, method, &queue_);
  call_->StartCall(this);
  Next();
}

UnreadCall::~UnreadCall() {
  context_.TryCancel();
  Finish();
  queue_.Shutdown();
  while (Next()) continue;
}

void UnreadCall::Send(const std::string& request) {
  const grpc::Slice bytes(request);
  call_->WriteLast(grpc::ByteBuffer(&bytes, 1), grpc::WriteOptions(), this);
  Next();
}

void UnreadCall::AwaitAnswer() {
  call_->ReadInitialMetadata(this);
  Next();
}

grpc::Status UnreadCall::Finish() {
  if (std::exchange(finished_, true)) return status_;
  call_->Finish(&status_, this);
  Next();
  return status_;
}

bool UnreadCall::Next() {
  void* tag = nullptr;
  bool ok = false;
  return queue_.Next(&tag, &ok);
}

}  // namespace ballpiston::server
