// Tells on standard error how a watched job gets on.
//
//   bar   one line, redrawn: bar, points, samples a second, time left, and the running estimate of
//         the point that changed last
//   json  one object a line: {"job", "state", "progress", "samples_per_second", "seconds_left",
//         "points"}, or a note's {"note"}; the points that changed since the line before,
//         unfinished ones first, the newest of each kind first; the state of a job that had ended
//         before is told last, and STATE_UNSPECIFIED with its points
//   none  nothing but notes
//
// Thread-safe: notes come from the thread that handles Ctrl-C while the bar is being redrawn.
#ifndef BALLPISTON_CLIENT_OUTPUT_PROGRESS_REPORTER_H_
#define BALLPISTON_CLIENT_OUTPUT_PROGRESS_REPORTER_H_

#include <memory>
#include <ostream>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"

namespace ballpiston::client {

enum class ProgressStyle { kBar, kJson, kNone };

// `auto` is a bar if standard error is a terminal.
absl::StatusOr<ProgressStyle> ParseProgressStyle(absl::string_view text);

class ProgressReporter {
 public:
  virtual ~ProgressReporter() = default;

  virtual void OnJob(const v1::EnsembleJob& job) = 0;
  virtual void OnSnapshot(const v1::StatisticsSnapshot& snapshot) = 0;
  virtual void OnDisconnect(const absl::Status& why, absl::Duration pause) = 0;
  virtual void OnEnd() = 0;  // the watch is over; nothing but notes comes after this
  // A line for the user that is not progress; shown whatever the style.
  virtual void Note(absl::string_view text) = 0;
};

// `name` is that of the job that is watched; it may be left out where there are only notes. `err`
// has to outlive the reporter.
std::unique_ptr<ProgressReporter> NewProgressReporter(ProgressStyle style, std::ostream& err,
                                                      absl::string_view name = "");

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_PROGRESS_REPORTER_H_
