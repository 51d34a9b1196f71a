// Client::Watch follows a job to its end, even if the server restarts or the connection breaks.
//
// A stream is broken if it ends with UNAVAILABLE, with CANCELLED and no reason (a server that stops
// does this), with RESOURCE_EXHAUSTED and a reason (the server has too many streams), or without a
// terminal state. The watch then pauses and reconnects with the last resume token that it received.
// The pauses double from `initial_backoff` to `max_backoff`, and are at least as long as the
// server's error says. The watch gives up if no message arrives within `give_up_after` of the
// moment at which the stream broke. Every other error ends the watch.
//
// Properties, each with a test of its name:
//   1. PassesTheLastResumeTokenOn.     2. ShowsTheTerminalStateOnce.
//   3. GivesUpAfterTheConfiguredTime.  4. AStopEndsTheWatchAtOnce.
//   5. WaitsForABusyServer.            6. ReturnsTheErrorOfAServerThatStaysBusy.
#pragma once

#include <functional>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"

namespace ballpiston::client {

// The watching thread calls these, one at a time. Any of them may be empty.
struct WatchCallbacks {
  std::function<void(const v1::EnsembleJob&)> on_job =
      {};  // at the start and on each change of state
  std::function<void(const v1::StatisticsSnapshot&)> on_snapshot = {};
  // The stream broke; the next attempt follows after `pause`.
  std::function<void(const absl::Status& why, absl::Duration pause)> on_disconnect = {};
};

struct WatchOptions {
  absl::Duration initial_backoff = absl::Milliseconds(100);
  absl::Duration max_backoff = absl::Seconds(5);
  absl::Duration give_up_after = absl::Minutes(2);
};

// SUCCEEDED, FAILED or CANCELLED.
bool HasEnded(v1::EnsembleJob::State state);

}  // namespace ballpiston::client
