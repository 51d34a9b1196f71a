// Calls of a server: channels, calls of any method in steps or at once, streams of messages, and a
// client with the frequent calls. Each call ends after 15 minutes (kPatience) with
// DEADLINE_EXCEEDED.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/server.pb.h"
#include "ballpiston/v1/trace.pb.h"
#include "google/protobuf/descriptor.h"
#include "grpcpp/grpcpp.h"
#include "grpcpp/support/sync_stream.h"
#include "tests/server/requests.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// A channel with a connection of its own. Other channels to the same address share a connection,
// also a connection to a server that has ended. `credentials` null: none.
std::shared_ptr<grpc::Channel> OwnChannel(
    const std::string& address,
    const std::shared_ptr<grpc::ChannelCredentials>& credentials = nullptr,
    grpc::ChannelArguments arguments = {});

// The server can send at most 64 KiB ahead of a reader. By default the window grows.
inline grpc::ChannelArguments SmallWindow() {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  return arguments;
}

// ---- a method by its name ----

inline constexpr char kListJobs[] = "/ballpiston.v1.EnsembleService/ListEnsembleJobs";
inline constexpr char kGetJob[] = "/ballpiston.v1.EnsembleService/GetEnsembleJob";
inline constexpr char kWatchJob[] = "/ballpiston.v1.EnsembleService/WatchEnsembleJob";
inline constexpr char kCheckHealth[] = "/grpc.health.v1.Health/Check";
inline constexpr char kWatchHealth[] = "/grpc.health.v1.Health/Watch";
inline constexpr char kReflection[] =
    "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";

inline std::string PathOf(const google::protobuf::MethodDescriptor& method) {
  return "/" + method.service()->full_name() + "/" + method.name();
}
// The path of the first method that takes such a request. Each .proto file has one service.
std::string PathOf(const google::protobuf::Descriptor& request);

// A request of a health watch, encoded by hand: an empty field 1 asks for the whole server.
inline const std::string kWholeServer("\x0a\0", 2);

// A request of reflection, encoded by hand: field 7 asks for the list of services.
inline constexpr char kListServices[] = "\x3a\x01*";

// The authorization headers of a call: one header, or none for an empty token.
inline std::vector<std::string> Bearer(const std::string& token) {
  return token.empty() ? std::vector<std::string>() : std::vector{"Bearer " + token};
}

// A call in steps.
class NamedCall {
 public:
  // Begins the call with these authorization headers.
  NamedCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
            const std::vector<std::string>& authorization = {});
  ~NamedCall();  // cancels it, if it has not ended

  void Send(const std::string& bytes);  // the only request, serialized
  // Waits until the server sends the first answer.
  void AwaitAnswer() { stream_->WaitForInitialMetadata(); }
  std::optional<std::string> Read();  // the next answer; empty at the end of the call
  grpc::Status Finish();              // waits until the server has ended the call
  grpc::Status End() {                // reads to the end
    while (Read()) continue;
    return Finish();
  }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> stream_;
  std::optional<grpc::Status> status_;
};

// Sends one request and reads to the end; `answer` gets the last message.
grpc::Status CallByName(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                        const std::string& bytes = "",
                        const std::vector<std::string>& authorization = {},
                        std::string* answer = nullptr);

// ---- a method by the type of its request ----

// A channel, and frequent calls on it. Calls that do not return a status expect OK.
class TestClient {
 public:
  explicit TestClient(std::shared_ptr<grpc::Channel> channel) : channel_(std::move(channel)) {}

  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

  grpc::Status Call(const google::protobuf::Message& request,
                    google::protobuf::Message* answer = nullptr) const;
  template <typename Answer>
  Answer Answered(const google::protobuf::Message& request) const {
    Answer answer;
    EXPECT_OK(Call(request, &answer));
    return answer;
  }

  v1::EnsembleJob Created(const v1::CreateEnsembleJobRequest& request) const {
    return Answered<v1::EnsembleJob>(request);
  }
  std::string Submit(const v1::EnsembleSpec& spec) const {  // creates a new job; its name
    return Created(FreshRequest(spec)).name();
  }
  std::string Succeeded(const v1::EnsembleSpec& spec) const;  // the same, and waits for success
  v1::EnsembleJob Get(const std::string& name) const {
    return Answered<v1::EnsembleJob>(RequestNaming<v1::GetEnsembleJobRequest>(name));
  }
  grpc::Status Cancel(const std::string& name, const std::string& request_id = "") const {
    auto request = RequestNaming<v1::CancelEnsembleJobRequest>(name);
    request.set_request_id(request_id);
    return Call(request);
  }
  grpc::Status Delete(const std::string& name) const {
    return Call(RequestNaming<v1::DeleteEnsembleJobRequest>(name));
  }
  v1::EnsembleJob AwaitEnd(const std::string& name) const {  // by watching it to its end
    return Answered<v1::WatchEnsembleJobResponse>(RequestNaming<v1::WatchEnsembleJobRequest>(name))
        .job();
  }
  v1::ServerStatus Status() const {
    return Answered<v1::ServerStatus>(v1::GetServerStatusRequest());
  }

  v1::ListEnsembleJobsResponse List(const v1::ListEnsembleJobsRequest& request = {}) const {
    return Answered<v1::ListEnsembleJobsResponse>(request);
  }
  // All pages, beginning with the page of `request`.
  template <typename Page, typename Request>
  std::vector<Page> Pages(Request request) const {
    std::vector<Page> pages;
    do {
      pages.push_back(Answered<Page>(request));
      request.set_page_token(pages.back().next_page_token());
    } while (!request.page_token().empty());
    return pages;
  }
  // All results of a job, each serialized, without its name, which has the job's id.
  std::vector<std::string> ResultBytes(const std::string& name) const;

 protected:
  std::shared_ptr<grpc::Channel> channel_;
};

// A stream of the server's messages.
template <typename Message>
struct MessageStream : NamedCall {
  MessageStream(const TestClient& client, const google::protobuf::Message& request)
      : NamedCall(client.channel(), PathOf(*request.GetDescriptor())) {
    Send(request.SerializeAsString());
  }

  std::optional<Message> Next() {
    const std::optional<std::string> bytes = Read();
    if (!bytes) return std::nullopt;
    Message message;
    EXPECT_TRUE(message.ParseFromString(*bytes));
    return message;
  }
  std::vector<Message> ToTheEnd() {
    std::vector<Message> messages;
    while (auto message = Next()) messages.push_back(*std::move(message));
    EXPECT_OK(Finish());
    return messages;
  }
};

using TraceStream = MessageStream<v1::TraceOrbitResponse>;
using WatchMessage = v1::WatchEnsembleJobResponse;

struct WatchStream : MessageStream<WatchMessage> {
  WatchStream(const TestClient& client, const std::string& name,
              const std::string& resume_token = "")
      : MessageStream(client, WatchRequest(name, resume_token)) {}
};

}  // namespace ballpiston::server
