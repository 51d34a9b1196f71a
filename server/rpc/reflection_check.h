// Reflection, the description of the API, needs a token like every call of the project, and all
// clients together have a limited number of its streams. The service is part of gRPC, so no other
// code authenticates its calls or counts its streams. Each stream has a thread until its client
// ends it. Thread-safe.
#pragma once

#include <atomic>

#include "grpcpp/support/server_interceptor.h"
#include "server/door/authenticator.h"

namespace ballpiston::server {

inline constexpr int kReflectionStreams = 32;

// Ends other streams with UNAUTHENTICATED or RESOURCE_EXHAUSTED.
class ReflectionCheck : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  // `authenticator` must outlive the server.
  explicit ReflectionCheck(const Authenticator& authenticator) : authenticator_(authenticator) {}

  grpc::experimental::Interceptor* CreateServerInterceptor(
      grpc::experimental::ServerRpcInfo* info) override;

 private:
  const Authenticator& authenticator_;
  std::atomic<int> streams_ = 0;
};

}  // namespace ballpiston::server
