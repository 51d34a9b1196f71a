// A thread that calls a function again and again.
#ifndef BALLPISTON_SERVER_PERIODIC_THREAD_H_
#define BALLPISTON_SERVER_PERIODIC_THREAD_H_

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace ballpiston::server {

class PeriodicThread {
 public:
  // Calls it at once, and then `interval` after each return.
  PeriodicThread(std::chrono::milliseconds interval, std::function<void()> call);
  ~PeriodicThread();  // returns when the last call has returned

 private:
  void CallUntilStopped();

  const std::chrono::milliseconds interval_;
  const std::function<void()> call_;
  std::mutex mutex_;
  std::condition_variable stop_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_PERIODIC_THREAD_H_
