#include "tests/server/calls.h"

#include "grpc/grpc.h"

namespace ballpiston::server {

using grpc::ByteBuffer;
using grpc::internal::RpcMethod;

std::shared_ptr<grpc::Channel> OwnChannel(
    const std::string& address, const std::shared_ptr<grpc::ChannelCredentials>& credentials,
    grpc::ChannelArguments arguments) {
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);  // whatever http_proxy is
  arguments.SetServiceConfigJSON(absl::StrCat(R"({"methodConfig": [{"name": [{}], "timeout": ")",
                                              std::chrono::seconds(kPatience).count(), R"(s"}]})"));
  return grpc::CreateCustomChannel(
      address, credentials != nullptr ? credentials : grpc::InsecureChannelCredentials(),
      arguments);
}

// ---- a method by its name ----

std::string PathOf(const google::protobuf::Descriptor& request) {
  const google::protobuf::ServiceDescriptor& service = *request.file()->service(0);
  for (int i = 0; i < service.method_count(); ++i) {
    if (service.method(i)->input_type() == &request) return PathOf(*service.method(i));
  }
  ADD_FAILURE() << "no method takes a " << request.full_name();
  return "";
}

// A unary method is called as a stream of one message.
NamedCall::NamedCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                     const std::vector<std::string>& authorization) {
  for (const std::string& value : authorization) context_.AddMetadata("authorization", value);
  stream_.reset(grpc::internal::ClientReaderWriterFactory<ByteBuffer, ByteBuffer>::Create(
      channel.get(), RpcMethod(method.c_str(), RpcMethod::BIDI_STREAMING), &context_));
}

NamedCall::~NamedCall() {
  context_.TryCancel();
  Finish();
}

void NamedCall::Send(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  stream_->WriteLast(ByteBuffer(&slice, 1), {});
}

std::optional<std::string> NamedCall::Read() {
  ByteBuffer answer;
  grpc::Slice slice;
  if (!stream_->Read(&answer) || !answer.DumpToSingleSlice(&slice).ok()) return std::nullopt;
  return std::string(slice.begin(), slice.end());
}

grpc::Status NamedCall::Finish() {
  if (!status_) status_ = stream_->Finish();
  return *status_;
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

// ---- TestClient ----

grpc::Status TestClient::Call(const google::protobuf::Message& request,
                              google::protobuf::Message* answer) const {
  std::string bytes;
  const grpc::Status status = CallByName(channel_, PathOf(*request.GetDescriptor()),
                                         request.SerializeAsString(), {}, &bytes);
  EXPECT_TRUE(answer == nullptr || answer->ParseFromString(bytes));
  return status;
}

std::string TestClient::Succeeded(const v1::EnsembleSpec& spec) const {
  const std::string name = Submit(spec);
  EXPECT_EQ(AwaitEnd(name).state(), v1::EnsembleJob::SUCCEEDED);
  return name;
}

std::vector<std::string> TestClient::ResultBytes(const std::string& name) const {
  v1::ListResultsRequest request;
  request.set_parent(name);
  std::vector<std::string> bytes;
  for (const auto& page : Pages<v1::ListResultsResponse>(request)) {
    for (v1::PointResult result : page.results()) {
      result.clear_name();
      bytes.push_back(result.SerializeAsString());
    }
  }
  return bytes;
}

}  // namespace ballpiston::server
