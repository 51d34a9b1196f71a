// A thread that calls a function again and again.
#ifndef BALLPISTON_SERVER_PERIODIC_THREAD_H_
#define BALLPISTON_SERVER_PERIODIC_THREAD_H_

#include <chrono>
#include <functional>
#include <thread>

#include "server/mutex.h"

namespace ballpiston::server {

class PeriodicThread {
 public:
  // Calls it at once, and then `interval` after each return, without a lock.
  PeriodicThread(std::chrono::milliseconds interval, std::function<void()> call);
  ~PeriodicThread();  // returns when the last call has returned

 private:
  void CallUntilStopped();

  const std::chrono::milliseconds interval_;
  const std::function<void()> call_;
  Mutex mutex_;
  Condition stop_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_PERIODIC_THREAD_H_
