// Whether anybody uses the server: calls and streams in progress, and since when there is none.
// Thread-safe.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_ACTIVITY_H_
#define BALLPISTON_SERVER_OBSERVABILITY_ACTIVITY_H_

#include <chrono>
#include <memory>

#include "server/mutex.h"

namespace ballpiston::server {

class Activity {
 public:
  using Clock = std::chrono::steady_clock;

  // A call is in progress as long as a copy of what is returned lives (at most as long as this).
  std::shared_ptr<void> Begin();

  // Something happened that keeps the server awake without being a call.
  void Touch();

  // How long nothing has happened; zero while a call is in progress.
  Clock::duration IdleFor() const;

 private:
  void End();

  mutable Mutex mutex_;
  int calls_ ABSL_GUARDED_BY(mutex_) = 0;
  Clock::time_point last_ ABSL_GUARDED_BY(mutex_) = Clock::now();
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_ACTIVITY_H_
