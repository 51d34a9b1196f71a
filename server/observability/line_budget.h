// How many lines of one kind may be written: whoever knocks at the door a thousand times a second
// must not fill the disk with the log of it.
//
// At most `lines` in any `period` that begins with a line; what is over that is counted, and the
// count is told with the next line that is written. Thread-safe.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_LINE_BUDGET_H_
#define BALLPISTON_SERVER_OBSERVABILITY_LINE_BUDGET_H_

#include <chrono>
#include <cstdint>
#include <optional>

#include "server/mutex.h"

namespace ballpiston::server {

class LineBudget {
 public:
  using Clock = std::chrono::steady_clock;

  LineBudget(int lines, Clock::duration period) : lines_(lines), period_(period) {}

  // How many were left out since the last line that was written; nothing if this one is left out.
  std::optional<int64_t> Take(Clock::time_point now);

 private:
  const int lines_;
  const Clock::duration period_;
  Mutex mutex_;
  Clock::time_point begin_ ABSL_GUARDED_BY(mutex_);
  int written_ ABSL_GUARDED_BY(mutex_) = 0;  // since begin_
  int64_t left_out_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_LINE_BUDGET_H_
