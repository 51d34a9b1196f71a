#include "server/observability/health.h"

#include <utility>

namespace ballpiston::server {

Health::Health(grpc::HealthCheckServiceInterface& health, Services services,
               std::function<bool()> store_fails, std::chrono::milliseconds interval)
    : health_(health), services_(std::move(services)), store_fails_(std::move(store_fails)) {
  for (const std::string& name : services_.all) health_.SetServingStatus(name, true);
  looking_ = std::make_unique<PeriodicThread>(interval, [this] { Look(); });
}

Health::~Health() { Drain(); }

void Health::Drain() {
  if (looking_ == nullptr) return;
  looking_.reset();
  health_.Shutdown();
}

void Health::Look() {
  const bool fails = store_fails_();
  if (std::exchange(failed_, fails) == fails) return;
  for (const std::string& name : services_.with_store) health_.SetServingStatus(name, !fails);
}

}  // namespace ballpiston::server
