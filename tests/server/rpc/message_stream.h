// A stream of the server's messages, message by message: a watch of a job, or a trace.
#pragma once

#include "tests/server/preamble.h"

namespace ballpiston::server {

template <typename Message>
struct MessageStream {
  // The type of the request decides the method.
  MessageStream(const TestClient& client, const google::protobuf::Message& request)
      : reader(grpc::internal::ClientReaderFactory<Message>::Create(
            client.channel().get(),
            grpc::internal::RpcMethod(PathOf(*request.GetDescriptor()).c_str(),
                                      grpc::internal::RpcMethod::SERVER_STREAMING),
            &context, request)) {}

  std::optional<Message> Next() {
    Message message;
    if (!reader->Read(&message)) return std::nullopt;
    return message;
  }
  std::vector<Message> ToTheEnd() {
    std::vector<Message> messages;
    while (auto message = Next()) messages.push_back(*message);
    return messages;
  }
  // Reads to the end, and returns the final status.
  grpc::Status End() {
    while (Next()) continue;
    return reader->Finish();
  }
  // Cancels the stream, as a client that needs no more messages.
  void Leave() {
    context.TryCancel();
    reader->Finish();
  }

  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReader<Message>> reader;
};

using WatchMessage = v1::WatchEnsembleJobResponse;

struct WatchStream : MessageStream<WatchMessage> {
  WatchStream(const TestClient& client, const std::string& name,
              const std::string& resume_token = "")
      : MessageStream(client, RequestOf(name, resume_token)) {}

  static v1::WatchEnsembleJobRequest RequestOf(const std::string& name,
                                               const std::string& resume_token) {
    v1::WatchEnsembleJobRequest request;
    request.set_name(name);
    request.set_resume_token(resume_token);
    return request;
  }
};

using TraceStream = MessageStream<v1::TraceOrbitResponse>;

}  // namespace ballpiston::server
