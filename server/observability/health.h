// What grpc.health.v1 answers: each service by its name, and the empty name for the whole server.
//
// While the disk refuses writes, the services that need it are NOT_SERVING, so that who can choose
// asks another server; the others, and the whole server, go on: whoever restarts what is not
// healthy would not help the disk. When the server stops, all are NOT_SERVING, for good.
// Thread-safe.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_HEALTH_H_
#define BALLPISTON_SERVER_OBSERVABILITY_HEALTH_H_

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
    std::vector<std::string> with_store;  // among them
  };

  // `store_fails` is asked every `interval`, on a thread of its own. `health` has to outlive this.
  Health(grpc::HealthCheckServiceInterface& health, Services services,
         std::function<bool()> store_fails, std::chrono::milliseconds interval);
  ~Health();

  void Drain();  // not from two threads at once

 private:
  void Look();

  grpc::HealthCheckServiceInterface& health_;
  const Services services_;
  const std::function<bool()> store_fails_;
  bool failed_ = false;                      // at the last look
  std::unique_ptr<PeriodicThread> looking_;  // null: drained
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_HEALTH_H_
