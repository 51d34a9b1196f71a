// Limits the reflection streams of all clients. The service is part of gRPC, so no other limit
// counts its streams. Each stream has a thread until its client ends it. Thread-safe.
#pragma once

#include <atomic>

#include "grpcpp/support/server_interceptor.h"

namespace ballpiston::server {

inline constexpr int kReflectionStreams = 32;

// Ends each further stream with RESOURCE_EXHAUSTED.
class ReflectionLimit : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  grpc::experimental::Interceptor* CreateServerInterceptor(
      grpc::experimental::ServerRpcInfo* info) override;

 private:
  std::atomic<int> streams_ = 0;
};

}  // namespace ballpiston::server
