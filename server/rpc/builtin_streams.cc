#include "server/rpc/builtin_streams.h"

#include <string>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "grpc/grpc.h"
#include "grpcpp/server_context.h"

namespace ballpiston::server {
namespace {

using grpc::experimental::InterceptionHookPoints;

class CountedStream : public grpc::experimental::Interceptor {
 public:
  // `authenticator`: null if the service needs no token.
  CountedStream(grpc::ServerContextBase& context, const Authenticator* authenticator, int most,
                std::atomic<int>& streams)
      : context_(context),
        authenticator_(authenticator),
        streams_(streams),
        is_within_limit_(++streams <= most) {}
  ~CountedStream() override { --streams_; }

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
    if (!is_within_limit_) {
      return absl::ResourceExhaustedError(
          absl::StrCat("all clients together have the maximum number of streams of this service, ",
                       authenticator_ ? kReflectionStreams : kHealthWatches, "; retry later"));
    }
    return authenticator_ ? authenticator_->Authenticate(context_).status() : absl::OkStatus();
  }

  grpc::ServerContextBase& context_;
  const Authenticator* const authenticator_;
  std::atomic<int>& streams_;
  const bool is_within_limit_;
};

}  // namespace

grpc::experimental::Interceptor* BuiltinStreams::CreateServerInterceptor(
    grpc::experimental::ServerRpcInfo* info) {
  const absl::string_view method = info->method();
  grpc::ServerContextBase& context = *info->server_context();
  if (absl::StartsWith(method, "/grpc.reflection.")) {
    return new CountedStream(context, &authenticator_, kReflectionStreams, reflection_streams_);
  }
  if (method == "/grpc.health.v1.Health/Watch") {
    return new CountedStream(context, nullptr, kHealthWatches, health_watches_);
  }
  return nullptr;
}

}  // namespace ballpiston::server
