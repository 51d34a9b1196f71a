// How much of the server each principal's calls, or its streams' messages, hold at this moment.
//
// A unary call holds its request from when it is let in, and its answer until the client has taken
// it: who sends calls and reads no answers holds them all. Thread-safe.
#ifndef BALLPISTON_SERVER_API_HELD_CALLS_H_
#define BALLPISTON_SERVER_API_HELD_CALLS_H_

#include <cstdint>
#include <map>
#include <string>

#include "absl/status/status.h"
#include "server/limits.h"
#include "server/mutex.h"

namespace ballpiston::server {

class HeldCalls {
 public:
  // One more, of so many bytes. RESOURCE_EXHAUSTED, TOO_MANY_CALLS: it is not held, for the
  // principal has as many calls as it may, or others that hold as many bytes as it may.
  absl::Status Begin(const std::string& principal, int64_t bytes, const Limits& limits);

  // The same refusal, of a call that is held already: when it would now get an answer to hold.
  absl::Status CheckRoom(const std::string& principal, const Limits& limits) const;
  void AddBytes(const std::string& principal, int64_t bytes);

  // Holds so many bytes, as a call of their own, if with them there are at most `limit`, or no
  // others. False: it does not.
  bool TryBegin(const std::string& principal, int64_t bytes, int64_t limit);

  // A call with all of its bytes is over.
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

#endif  // BALLPISTON_SERVER_API_HELD_CALLS_H_
