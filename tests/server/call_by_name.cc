#include "tests/server/call_by_name.h"

#include <chrono>

#include "grpcpp/completion_queue.h"
#include "grpcpp/generic/generic_stub.h"
#include "tests/support/await.h"

namespace ballpiston::server {
namespace {

grpc::ByteBuffer Buffer(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  return grpc::ByteBuffer(&slice, 1);
}

}  // namespace

grpc::Status CallByName(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                        const std::string& bytes, const std::vector<std::string>& authorization) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  for (const std::string& value : authorization) context.AddMetadata("authorization", value);
  grpc::CompletionQueue queue;
  grpc::GenericStub stub(channel);
  const auto call = stub.PrepareCall(&context, method, &queue);
  const auto done = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  call->StartCall(nullptr);
  grpc::ByteBuffer response;
  if (done()) {
    call->WriteLast(Buffer(bytes), {}, nullptr);
    done();
  }
  // Also after a failure. If the server closes the connection before it has begun the call,
  // gRPC 1.51 reports a failed write, and then sends the whole call again on another connection.
  // Finish does not return before the answer to that has been read.
  do call->Read(&response, nullptr);
  while (done());
  grpc::Status status;
  call->Finish(&status, nullptr);
  done();
  return status;
}

std::vector<std::string> Bearer(const std::string& token) {
  if (token.empty()) return {};
  return {"Bearer " + token};
}

}  // namespace ballpiston::server
