// A stream of the server's messages, message by message: a watch of a job, or a trace.
#pragma once

#include "tests/server/preamble.h"

namespace ballpiston::server {

template <typename Message>
struct MessageStream {
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
  WatchStream(TestClient& client, const std::string& name, const std::string& resume_token = "") {
    v1::WatchEnsembleJobRequest request;
    request.set_name(name);
    request.set_resume_token(resume_token);
    reader = client.ensemble().WatchEnsembleJob(&context, request);
  }

  // Reads until a message meets the condition, and returns this message.
  template <typename Condition>
  WatchMessage Until(Condition condition) {
    while (auto message = Next()) {
      if (condition(*message)) return *message;
    }
    ADD_FAILURE() << "the stream ended: " << reader->Finish().error_message();
    return {};
  }
};

struct TraceStream : MessageStream<v1::TraceOrbitResponse> {
  TraceStream(TestClient& client, const v1::TraceOrbitRequest& request) {
    reader = client.trace().TraceOrbit(&context, request);
  }
};

}  // namespace ballpiston::server
