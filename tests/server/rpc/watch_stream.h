// One watch of a job, message by message.
#pragma once

#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {

using WatchMessage = v1::WatchEnsembleJobResponse;

struct WatchStream {
  WatchStream(TestClient& client, const std::string& name, const std::string& resume_token = "") {
    v1::WatchEnsembleJobRequest request;
    request.set_name(name);
    request.set_resume_token(resume_token);
    reader = client.ensemble().WatchEnsembleJob(&context, request);
  }

  std::optional<WatchMessage> Next() {
    WatchMessage message;
    if (!reader->Read(&message)) return std::nullopt;
    return message;
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
  std::vector<WatchMessage> ToTheEnd() {
    std::vector<WatchMessage> messages;
    while (auto message = Next()) messages.push_back(*message);
    return messages;
  }
  // Reads to the end, and returns the final status.
  grpc::Status End() {
    ToTheEnd();
    return reader->Finish();
  }
  // Cancels the watch, as a client that needs no more messages.
  void Leave() {
    context.TryCancel();
    reader->Finish();
  }

  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReader<WatchMessage>> reader;
};

}  // namespace ballpiston::server
