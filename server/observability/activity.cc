#include "server/observability/activity.h"

namespace ballpiston::server {

std::shared_ptr<void> Activity::Begin() {
  {
    MutexLock lock(mutex_);
    ++calls_;
  }
  return std::shared_ptr<void>(this, [this](void*) { End(); });
}

void Activity::End() {
  MutexLock lock(mutex_);
  --calls_;
  last_ = Clock::now();
}

void Activity::Touch() {
  MutexLock lock(mutex_);
  last_ = Clock::now();
}

Activity::Clock::duration Activity::IdleFor() const {
  MutexLock lock(mutex_);
  return calls_ > 0 ? Clock::duration::zero() : Clock::now() - last_;
}

}  // namespace ballpiston::server
