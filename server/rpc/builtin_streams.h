// Limits the streams of gRPC's own services, which no other code counts. Thread-safe.
//
// All clients together have a limited number of streams of each service. Reflection, the
// description of the API, also needs a token like every call of the project; each of its streams
// has a thread. Health needs no token; a watch has no thread, but some 20 kB of memory.
#pragma once

#include <atomic>

#include "grpcpp/support/server_interceptor.h"
#include "server/door/authenticator.h"

namespace ballpiston::server {

inline constexpr int kReflectionStreams = 32;
inline constexpr int kHealthWatches = 1'000;

// Ends a stream beyond the limit with RESOURCE_EXHAUSTED, and reflection without a valid token with
// UNAUTHENTICATED.
class BuiltinStreams : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  // `authenticator` must outlive the server.
  explicit BuiltinStreams(const Authenticator& authenticator) : authenticator_(authenticator) {}

  grpc::experimental::Interceptor* CreateServerInterceptor(
      grpc::experimental::ServerRpcInfo* info) override;

 private:
  const Authenticator& authenticator_;
  std::atomic<int> reflection_streams_ = 0;
  std::atomic<int> health_watches_ = 0;
};

}  // namespace ballpiston::server
