// Counts the calls and streams in progress, and how long the server has been idle. Thread-safe.
#pragma once

#include <chrono>
#include <memory>

#include "server/mutex.h"

namespace ballpiston::server {

class Activity {
 public:
  using Clock = std::chrono::steady_clock;

  // A call begins. It is in progress until the last copy of the returned pointer is gone. This
  // object must outlive the copies.
  std::shared_ptr<void> Begin();

  // Resets the idle time, for an event that is not a call.
  void Touch();

  // The time since the last event; zero while a call is in progress.
  Clock::duration IdleFor() const;

 private:
  void End();

  mutable Mutex mutex_;
  int calls_ ABSL_GUARDED_BY(mutex_) = 0;
  Clock::time_point last_ ABSL_GUARDED_BY(mutex_) = Clock::now();
};

}  // namespace ballpiston::server
