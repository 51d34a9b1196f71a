// Sets the answers of grpc.health.v1: each service by its name, and the empty name for the whole
// server.
//
// While the disk rejects writes, the services that need it are NOT_SERVING, so that clients can
// choose another server. The other services and the whole server stay SERVING, because a restart
// would not repair the disk. When the server stops, all are NOT_SERVING and stay so. Thread-safe.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "grpcpp/health_check_service_interface.h"
#include "server/periodic_thread.h"

namespace ballpiston::server {

class Health {
 public:
  struct Services {
    std::vector<std::string> all;
    std::vector<std::string> with_store;  // those of `all` that need the store
  };

  // A thread of this object calls `store_fails` every `interval`. `health` must outlive this.
  Health(grpc::HealthCheckServiceInterface& health, Services services,
         std::function<bool()> store_fails, std::chrono::milliseconds interval);
  ~Health();

  void Drain();  // one thread at a time

 private:
  void Look();

  grpc::HealthCheckServiceInterface& health_;
  const Services services_;
  const std::function<bool()> store_fails_;
  bool failed_ = false;                      // at the last look
  std::unique_ptr<PeriodicThread> looking_;  // null: drained
};

}  // namespace ballpiston::server
