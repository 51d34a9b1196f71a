// Writes the log to a descriptor, whose reader may be slow or gone.
//
// A write waits at most 100 ms for a slow reader. If the reader takes nothing, the line is dropped
// and counted, and the server goes on. The number of dropped lines is written before the next line.
// The same holds if the descriptor is closed or its disk is full. Thread-safe.
#pragma once

#include <cstdint>
#include <string>

#include "absl/functional/function_ref.h"
#include "absl/strings/string_view.h"
#include "server/mutex.h"

namespace ballpiston::server {

class LogOutput {
 public:
  explicit LogOutput(int descriptor) : descriptor_(descriptor) {}

  // `line` ends with a newline and has at most kMaxLogLine bytes (log_line.h). `loss` makes a line
  // that gives the number of dropped lines.
  void Write(absl::string_view line, absl::FunctionRef<std::string(int64_t lost)> loss);

 private:
  bool Put(absl::string_view line) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool PutWhole(absl::string_view text) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool AwaitRoom() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const int descriptor_;
  Mutex mutex_;  // also keeps the pieces of different lines apart
  bool stalled_ ABSL_GUARDED_BY(mutex_) = false;
  bool torn_ ABSL_GUARDED_BY(mutex_) = false;  // the last line was written only in part
  int64_t lost_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace ballpiston::server
