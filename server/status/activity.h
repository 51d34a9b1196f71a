// Counts the calls and streams in progress, and how long the server has been idle. Thread-safe.
#pragma once

#include <chrono>

#include "server/mutex.h"

namespace ballpiston::server {

class Activity {
 public:
  using Clock = std::chrono::steady_clock;

  // A call is in progress from Begin to End.
  void Begin() { Add(1); }
  void End() { Add(-1); }

  // Resets the idle time, for an event that is not a call.
  void Touch() { Add(0); }

  // The time since the last event; zero while a call is in progress.
  Clock::duration IdleFor() const {
    MutexLock lock(mutex_);
    return calls_ > 0 ? Clock::duration::zero() : Clock::now() - last_;
  }

 private:
  void Add(int calls) {
    MutexLock lock(mutex_);
    calls_ += calls;
    last_ = Clock::now();
  }

  mutable Mutex mutex_;
  int calls_ ABSL_GUARDED_BY(mutex_) = 0;
  Clock::time_point last_ ABSL_GUARDED_BY(mutex_) = Clock::now();
};

}  // namespace ballpiston::server
