// A call of any method whose answers nobody reads, until it ends.
#ifndef BALLPISTON_TESTS_SERVER_UNREAD_CALL_H_
#define BALLPISTON_TESTS_SERVER_UNREAD_CALL_H_

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

  // The only one.
  void Send(const std::string& request);
  // Until the first answer is on its way.
  void AwaitAnswer();
  // Until the server has ended it, 10 min after its beginning at the latest.
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

#endif  // BALLPISTON_TESTS_SERVER_UNREAD_CALL_H_
