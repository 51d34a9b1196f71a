#include "server/api/reflection_limit.h"

#include "absl/strings/match.h"
#include "grpc/grpc.h"
#include "grpcpp/server_context.h"

namespace ballpiston::server {
namespace {

using grpc::experimental::InterceptionHookPoints;

class ReflectionStream : public grpc::experimental::Interceptor {
 public:
  ReflectionStream(grpc::ServerContext& context, std::atomic<int>& streams)
      : context_(context), streams_(streams), is_surplus_(++streams > kReflectionStreams) {}
  ~ReflectionStream() override { --streams_; }

  // This is the first hook at which gRPC can cancel a stream. The service then reads no request and
  // returns.
  void Intercept(grpc::experimental::InterceptorBatchMethods* batch) override {
    constexpr auto kBegun = InterceptionHookPoints::POST_RECV_INITIAL_METADATA;
    if (is_surplus_ && batch->QueryInterceptionHookPoint(kBegun)) {
      grpc_call_cancel_with_status(context_.c_call(), GRPC_STATUS_RESOURCE_EXHAUSTED,
                                   "too many reflection streams; retry later", nullptr);
    }
    batch->Proceed();
  }

 private:
  grpc::ServerContext& context_;
  std::atomic<int>& streams_;
  const bool is_surplus_;
};

}  // namespace

grpc::experimental::Interceptor* ReflectionLimit::CreateServerInterceptor(
    grpc::experimental::ServerRpcInfo* info) {
  if (!absl::StartsWith(info->method(), "/grpc.reflection.")) return nullptr;
  return new ReflectionStream(static_cast<grpc::ServerContext&>(*info->server_context()), streams_);
}

}  // namespace ballpiston::server
