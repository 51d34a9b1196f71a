#include "server/periodic_thread.h"

#include <utility>

namespace ballpiston::server {

PeriodicThread::PeriodicThread(std::chrono::milliseconds interval, std::function<void()> call)
    : interval_(interval), call_(std::move(call)), thread_([this] { CallUntilStopped(); }) {}

PeriodicThread::~PeriodicThread() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_all();
  thread_.join();
}

void PeriodicThread::CallUntilStopped() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    lock.unlock();
    call_();
    lock.lock();
    stop_.wait_for(lock, interval_, [this] { return stopping_; });
  }
}

}  // namespace ballpiston::server
