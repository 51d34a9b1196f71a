// A call of any method, unary or streaming, by its name.
#pragma once

#include "google/protobuf/descriptor.h"
#include "grpcpp/channel.h"
#include "grpcpp/grpcpp.h"
#include "grpcpp/support/sync_stream.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

inline constexpr char kListJobs[] = "/ballpiston.v1.EnsembleService/ListEnsembleJobs";
inline constexpr char kGetJob[] = "/ballpiston.v1.EnsembleService/GetEnsembleJob";
inline constexpr char kWatchJob[] = "/ballpiston.v1.EnsembleService/WatchEnsembleJob";
inline constexpr char kCheckHealth[] = "/grpc.health.v1.Health/Check";
inline constexpr char kWatchHealth[] = "/grpc.health.v1.Health/Watch";
inline constexpr char kReflection[] =
    "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";

std::string PathOf(const google::protobuf::MethodDescriptor& method);
// The path of the first method that takes such a request. Each .proto file has one service.
std::string PathOf(const google::protobuf::Descriptor& request);

// A request of a health watch, encoded by hand: an empty field 1 asks for the whole server.
inline const std::string kWholeServer("\x0a\0", 2);

// A request of reflection, encoded by hand: field 7 asks for the list of services.
inline constexpr char kListServices[] = "\x3a\x01*";

// A call in steps. It ends after kPatience with DEADLINE_EXCEEDED.
class NamedCall {
 public:
  // Begins the call with these values of the header `authorization`.
  NamedCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
            const std::vector<std::string>& authorization = {});
  ~NamedCall();  // cancels it, if it has not ended

  void Send(const std::string& bytes);  // the only request, serialized
  // Waits until the server sends the first answer.
  void AwaitAnswer() { stream_->WaitForInitialMetadata(); }
  std::optional<std::string> Read();  // the next answer; empty at the end of the call
  grpc::Status Finish();              // waits until the server has ended the call

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

// One header, or none for an empty token.
std::vector<std::string> Bearer(const std::string& token);

}  // namespace ballpiston::server
