// When a watch that lost its server attaches again, and when it gives up: after pauses that double
// from `initial_backoff` to `max_backoff`, each up to a quarter longer, so that the watchers of a
// server that died do not return as one; until nothing was heard for `give_up_after`.
//
// The times are the caller's, so that this can be tested without waiting. Not thread-safe.
#ifndef BALLPISTON_CLIENT_LIBRARY_REATTACH_PACE_H_
#define BALLPISTON_CLIENT_LIBRARY_REATTACH_PACE_H_

#include <chrono>
#include <optional>

#include "absl/random/random.h"
#include "absl/time/time.h"
#include "client/library/job_watch.h"

namespace ballpiston::client {

class ReattachPace {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Reads the three times of `options`, which outlive this. `now`: when the watch begins.
  ReattachPace(const WatchOptions& options, Time now);

  // The server said something: both the pauses and the time to give up start again.
  void Heard(Time now);

  // Before the next attempt; empty if that would come after the time to give up.
  std::optional<absl::Duration> NextPause(Time now);

 private:
  const WatchOptions& options_;
  Time heard_;
  absl::Duration backoff_;
  absl::InsecureBitGen random_;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_REATTACH_PACE_H_
