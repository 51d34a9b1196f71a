// Limits how many log lines of one kind are written, so that a client with a thousand rejected
// calls a second does not fill the disk with the log.
//
// At most `lines` lines are written in a `period`, which begins with a line. Further lines are
// counted, and the next line that is written gives their number. Thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "server/mutex.h"

namespace ballpiston::server {

class LineBudget {
 public:
  using Clock = std::chrono::steady_clock;

  LineBudget(int lines, Clock::duration period) : lines_(lines), period_(period) {}

  // Empty if this line is to be left out. Otherwise the number of lines that were left out since
  // the last written line.
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
