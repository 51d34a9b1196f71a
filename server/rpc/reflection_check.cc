#include "server/rpc/reflection_check.h"

#include <string>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "grpc/grpc.h"
#include "grpcpp/server_context.h"

namespace ballpiston::server {
namespace {

using grpc::experimental::InterceptionHookPoints;

class ReflectionStream : public grpc::experimental::Interceptor {
 public:
  ReflectionStream(grpc::ServerContext& context, const Authenticator& authenticator,
                   std::atomic<int>& streams)
      : context_(context), authenticator_(authenticator), streams_(streams), number_(++streams) {}
  ~ReflectionStream() override { --streams_; }

  // This is the first hook at which gRPC can cancel a stream. The service then reads no request and
  // returns.
  void Intercept(grpc::experimental::InterceptorBatchMethods* batch) override {
    constexpr auto kBegun = InterceptionHookPoints::POST_RECV_INITIAL_METADATA;
    const absl::Status status =
        batch->QueryInterceptionHookPoint(kBegun) ? Check() : absl::OkStatus();
    if (!status.ok()) {
      grpc_call_cancel_with_status(context_.c_call(), static_cast<grpc_status_code>(status.code()),
                                   std::string(status.message()).c_str(), nullptr);
    }
    batch->Proceed();
  }

 private:
  absl::Status Check() const {
    if (number_ <= kReflectionStreams) return authenticator_.Authenticate(context_).status();
    return absl::ResourceExhaustedError("too many reflection streams; retry later");
  }

  grpc::ServerContext& context_;
  const Authenticator& authenticator_;
  std::atomic<int>& streams_;
  const int number_;
};

}  // namespace

grpc::experimental::Interceptor* ReflectionCheck::CreateServerInterceptor(
    grpc::experimental::ServerRpcInfo* info) {
  if (!absl::StartsWith(info->method(), "/grpc.reflection.")) return nullptr;
  return new ReflectionStream(static_cast<grpc::ServerContext&>(*info->server_context()),
                              authenticator_, streams_);
}

}  // namespace ballpiston::server
