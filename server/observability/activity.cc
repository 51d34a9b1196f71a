#include "server/observability/activity.h"

namespace ballpiston::server {

std::shared_ptr<void> Activity::Begin() {
  {
    std::lock_guard lock(mutex_);
    ++calls_;
  }
  return std::shared_ptr<void>(this, [this](void*) { End(); });
}

void Activity::End() {
  std::lock_guard lock(mutex_);
  --calls_;
  last_ = Clock::now();
}

void Activity::Touch() {
  std::lock_guard lock(mutex_);
  last_ = Clock::now();
}

Activity::Clock::duration Activity::IdleFor() const {
  std::lock_guard lock(mutex_);
  return calls_ > 0 ? Clock::duration::zero() : Clock::now() - last_;
}

}  // namespace ballpiston::server
