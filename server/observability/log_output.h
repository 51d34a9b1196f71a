// Where the log goes: a descriptor that somebody else reads, or does not.
//
// A reader that is slow is waited for, 100 ms at most; one that takes nothing any more costs the
// lines, not the server: they are counted, and the number stands before the next line that is
// taken. The same if the descriptor is closed or its disk is full. Thread-safe.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_LOG_OUTPUT_H_
#define BALLPISTON_SERVER_OBSERVABILITY_LOG_OUTPUT_H_

#include <cstdint>
#include <string>

#include "absl/functional/function_ref.h"
#include "absl/strings/string_view.h"
#include "server/mutex.h"

namespace ballpiston::server {

class LogOutput {
 public:
  explicit LogOutput(int descriptor) : descriptor_(descriptor) {}

  // The line has its end, and at most kMaxLogLine bytes (log_line.h). `loss` makes one that says
  // how many were lost.
  void Write(absl::string_view line, absl::FunctionRef<std::string(int64_t lost)> loss);

 private:
  bool Put(absl::string_view line) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool PutWhole(absl::string_view text) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool AwaitRoom() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const int descriptor_;
  Mutex mutex_;  // lines taken in pieces are not mixed
  bool stalled_ ABSL_GUARDED_BY(mutex_) = false;
  bool torn_ ABSL_GUARDED_BY(mutex_) = false;  // a line without its end was written
  int64_t lost_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_LOG_OUTPUT_H_
