#include "server/periodic_thread.h"

#include <utility>

namespace ballpiston::server {

PeriodicThread::PeriodicThread(std::chrono::milliseconds interval, std::function<void()> call)
    : interval_(interval), call_(std::move(call)), thread_([this] { CallUntilStopped(); }) {}

PeriodicThread::~PeriodicThread() {
  {
    MutexLock lock(mutex_);
    stopping_ = true;
  }
  stop_.NotifyAll();
  thread_.join();
}

void PeriodicThread::CallUntilStopped() {
  for (auto next = SteadyNow(); Await(next); next = SteadyNow() + interval_) call_();
}

bool PeriodicThread::Await(std::chrono::steady_clock::time_point next) {
  MutexLock lock(mutex_);
  while (!stopping_ && stop_.WaitUntil(mutex_, next)) continue;
  return !stopping_;
}

}  // namespace ballpiston::server
