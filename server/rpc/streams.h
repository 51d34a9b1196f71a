// The streams in progress: watches and traces. Each has a thread, which waits while its reader does
// not read. Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "grpcpp/server_context.h"
#include "server/door/authenticator.h"
#include "server/mutex.h"

namespace ballpiston::server {

class Stream;

class Streams {
 public:
  Streams(const Authenticator& authenticator, std::chrono::milliseconds heartbeat,
          const std::atomic<bool>& draining)
      : authenticator_(authenticator), heartbeat_(heartbeat), draining_(draining) {}

  // Ends the streams whose readers stall and whose credentials are no longer valid. Call a few
  // times a second.
  void EndRevoked();

 private:
  friend class Stream;

  const Authenticator& authenticator_;
  const std::chrono::milliseconds heartbeat_;
  const std::atomic<bool>& draining_;
  Mutex mutex_;
  std::set<Stream*> streams_ ABSL_GUARDED_BY(mutex_);
};

// One stream. Its thread calls Proceed before each message and after each wait.
class Stream {
 public:
  using Clock = std::chrono::steady_clock;

  Stream(Streams& all, grpc::ServerContext& context, Principal caller);
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  // Its role may change at a heartbeat.
  const Principal& caller() const { return caller_; }

  // OK if the stream may go on. Once per heartbeat it checks the credentials.
  //   CANCELLED        the client is gone
  //   UNAVAILABLE      SHUTTING_DOWN
  //   UNAUTHENTICATED  the credentials are no longer valid, or are another principal's
  absl::Status Proceed();

  // When Proceed checks the credentials again.
  Clock::time_point next_check() const { return next_check_; }

 private:
  friend class Streams;

  absl::StatusOr<Principal> Authenticate() const;

  Streams& all_;
  grpc::ServerContext& context_;
  Principal caller_;
  const std::string name_;  // of the caller
  std::atomic<Clock::time_point> next_check_;
};

}  // namespace ballpiston::server
