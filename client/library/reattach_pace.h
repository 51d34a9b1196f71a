// When a watch that lost its server retries, and when it gives up. The pauses double from
// `initial_backoff` to `max_backoff`; each is up to a quarter longer at random, so that the
// watchers of a restarted server do not all reconnect at the same moment. The watch gives up when
// it has received nothing for `give_up_after`.
//
// The caller passes the times, so that tests need not wait. Not thread-safe.
#pragma once

#include <chrono>
#include <optional>

#include "absl/random/random.h"
#include "absl/time/time.h"
#include "client/library/job_watch.h"

namespace ballpiston::client {

class ReattachPace {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Reads the three times of `options`, which must outlive this object. `now`: the watch's start.
  ReattachPace(const WatchOptions& options, Time now);

  // The watch received a message: the pauses and the time until it gives up start again.
  void Heard(Time now);

  // The pause before the next attempt, at least `least`; empty if it would end after the time to
  // give up.
  std::optional<absl::Duration> NextPause(Time now, absl::Duration least = absl::ZeroDuration());

 private:
  const WatchOptions& options_;
  Time heard_;
  absl::Duration backoff_;
  absl::InsecureBitGen random_;
};

}  // namespace ballpiston::client
