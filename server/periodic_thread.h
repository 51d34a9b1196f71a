// A thread that calls a function again and again.
#pragma once

#include <chrono>
#include <functional>

#include "server/host.h"
#include "server/mutex.h"

namespace ballpiston::server {

class PeriodicThread {
 public:
  // Calls `call` at once, and again `interval` after each return. No lock is held during a call.
  PeriodicThread(std::chrono::milliseconds interval, std::function<void()> call);
  ~PeriodicThread();  // returns when the last call has returned

 private:
  void CallUntilStopped();
  bool Await(std::chrono::steady_clock::time_point next);  // false: the thread ends

  const std::chrono::milliseconds interval_;
  const std::function<void()> call_;
  Mutex mutex_;
  Condition stop_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  Thread thread_;
};

}  // namespace ballpiston::server
