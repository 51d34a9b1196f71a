// Counts the calls in progress of each principal, and the bytes of memory that these calls and the
// messages of its streams hold.
//
// A unary call holds its request from its admission, and its answer until the client has received
// it. A client that sends calls and does not read the answers therefore reaches the limits.
// Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "absl/status/status.h"
#include "server/limits.h"
#include "server/mutex.h"

namespace ballpiston::server {

class HeldCalls {
 public:
  // Counts a new call with this many bytes. RESOURCE_EXHAUSTED, TOO_MANY_CALLS if the principal has
  // reached its limit of calls or of bytes; the call is then not counted.
  absl::Status Begin(const std::string& principal, int64_t bytes, const Limits& limits);

  // The same error, for a call that is counted already, before the server adds the bytes of its
  // answer.
  absl::Status CheckRoom(const std::string& principal, const Limits& limits) const;
  void AddBytes(const std::string& principal, int64_t bytes);

  // Counts this many bytes as a separate call if the principal then holds at most `limit` bytes, or
  // if it holds no others. Returns false, and counts nothing, otherwise.
  bool TryBegin(const std::string& principal, int64_t bytes, int64_t limit);

  // A call with this many bytes has ended.
  void End(const std::string& principal, int64_t bytes);

 private:
  struct Held {
    int64_t calls = 0;
    int64_t bytes = 0;
  };

  mutable Mutex mutex_;
  std::map<std::string, Held> held_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
