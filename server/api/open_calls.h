// The calls in progress of each principal, with their memory: the request, and the answer until the
// client has received it, or what a trace computes. A client that sends calls and does not read the
// answers therefore reaches the limits. Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "server/limits.h"
#include "server/mutex.h"

namespace ballpiston::server {

class OpenCalls {
 public:
  // A call in progress, until this object is destroyed. OpenCalls must outlive it.
  class Call {
   public:
    ~Call();
    void AddBytes(int64_t bytes);

   private:
    friend class OpenCalls;
    Call(OpenCalls& all, std::string principal);

    OpenCalls& all_;
    const std::string principal_;
    std::optional<int64_t> bytes_;  // empty until the call is counted
  };

  explicit OpenCalls(const Limits& limits) : limits_(limits) {}

  // RESOURCE_EXHAUSTED, TOO_MANY_CALLS: the principal has reached its limit of calls or of bytes. A
  // single call may have any number of bytes.
  absl::StatusOr<std::shared_ptr<Call>> Begin(const std::string& principal, int64_t bytes);

 private:
  struct Held {
    int64_t calls = 0;
    int64_t bytes = 0;
  };

  const Limits& limits_;
  Mutex mutex_;
  std::map<std::string, Held> held_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
