#include "server/observability/health.h"

#include <utility>

namespace ballpiston::server {

Health::Health(grpc::HealthCheckServiceInterface& health, Services services,
               std::function<bool()> store_fails, std::chrono::milliseconds interval)
    : health_(health),
      services_(std::move(services)),
      store_fails_(std::move(store_fails)),
      interval_(interval) {
  for (const std::string& name : services_.all) health_.SetServingStatus(name, true);
  thread_ = std::thread([this] { Look(); });
}

Health::~Health() { Drain(); }

void Health::Drain() {
  {
    MutexLock lock(mutex_);
    if (stopping_) return;
    stopping_ = true;
  }
  stop_.NotifyAll();
  thread_.join();
  health_.Shutdown();
}

void Health::Look() {
  bool failed = false;
  MutexLock lock(mutex_);
  while (!stopping_) {
    const bool fails = store_fails_();
    if (std::exchange(failed, fails) != fails) {
      for (const std::string& name : services_.with_store) health_.SetServingStatus(name, !fails);
    }
    const auto next = std::chrono::steady_clock::now() + interval_;
    while (!stopping_ && stop_.WaitUntil(mutex_, next)) continue;
  }
}

}  // namespace ballpiston::server
