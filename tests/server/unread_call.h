// A call of any method whose answers nobody reads, until it ends.
#pragma once

#include <memory>
#include <string>

#include "grpcpp/channel.h"
#include "grpcpp/generic/generic_stub.h"
#include "grpcpp/grpcpp.h"

namespace ballpiston::server {

class UnreadCall {
 public:
  UnreadCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method);
  ~UnreadCall();  // cancels it, if it has not ended
  UnreadCall(const UnreadCall&) = delete;
  UnreadCall& operator=(const UnreadCall&) = delete;

  // Sends the only request.
  void Send(const std::string& request);
  // Waits until the server sends the first answer.
  void AwaitAnswer();
  // Waits until the server has ended the call, at most 10 min after its start.
  grpc::Status Finish();

 private:
  bool Next();  // false: the queue is empty

  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  grpc::GenericStub stub_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
  grpc::Status status_;
  bool finished_ = false;
};

}  // namespace ballpiston::server
