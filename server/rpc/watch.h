// A watch of a job: sends its state, its progress and its points.
//
// The watch makes a message when its reader has taken the previous one. It reads the state from the
// job's row after a change of state was committed. Of an unfinished point it sends the newest
// state. It reads finished points from the store when it sends them. A snapshot needs the
// scheduler's lock; the watches of one job share their snapshots. With many watches each gets
// snapshots less often, so that all of them together take at most kSnapshotsPerSecond.
//
// Properties of a watch and of the watches that resume it (checked in tests/simulation):
//   1. Each finished point is sent once, in order: also over restarts, and before the terminal
//      state.
//   2. A state never goes back. Progress never goes back within one watch, except that the samples
//      of a point's warm-up no longer count when the point is finished.
//   3. The terminal state is sent once, last, and then OK. So the watch of a job that has ended
//      begins with the finished points that were not sent yet.
//
// The resume token names the job, the number of its restarts by other engines, and the last
// finished point that was sent. For unfinished points it also has the server process and the last
// change that was sent. The watch ignores some tokens and sends everything: a token of another job,
// of results that were dropped because another engine computes the job again, or of points that the
// store does not have. With a token of an earlier server process, it sends only the unfinished
// points again.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/book/job_book.h"
#include "server/door/principal.h"

namespace ballpiston::server {

struct WatchTiming {
  std::chrono::milliseconds snapshot{200};      // least time between two snapshots
  std::chrono::milliseconds heartbeat{10'000};  // sent if no other message was sent in this time
};

// The client that reads the messages of a watch.
class WatchReader {
 public:
  virtual ~WatchReader() = default;
  virtual const Principal& caller() const = 0;
  // OK if the watch may go on. Called before each message and after each wait.
  virtual absl::Status Proceed() = 0;
  // The time of the next check in Proceed.
  virtual std::chrono::steady_clock::time_point next_check() const = 0;
  virtual int64_t watches() const = 0;  // of all readers, now
  // Waits until the reader takes the message. False: the reader is gone.
  virtual bool Write(const v1::WatchEnsembleJobResponse& message) = 0;
};

// `instance` names the server process, which numbers the changes. Returns when the job's end was
// sent, or with an error.
absl::Status RunWatch(JobBook& book, const WatchTiming& timing, const std::string& instance,
                      const v1::WatchEnsembleJobRequest& request, WatchReader& reader);

}  // namespace ballpiston::server
