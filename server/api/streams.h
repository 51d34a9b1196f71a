// The streams in progress: watches and traces. Each has a thread, which waits while its reader does
// not read. Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "grpcpp/server_context.h"
#include "server/door/authenticator.h"
#include "server/limits.h"
#include "server/mutex.h"

namespace ballpiston::server {

class Streams;

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

  Streams& all_;
  grpc::ServerContext& context_;
  Principal caller_;
  const std::string name_;  // of the caller
  std::atomic<Clock::time_point> next_check_;
};

class Streams {
 public:
  Streams(const Limits& limits, const Authenticator& authenticator,
          std::chrono::milliseconds heartbeat, const std::atomic<bool>& draining);

  // RESOURCE_EXHAUSTED, TOO_MANY_STREAMS. Otherwise the stream is counted until its destructor.
  absl::Status Add(Stream& stream);

  // Ends the streams whose readers stall and whose credentials are no longer valid. Call about
  // twice a second.
  void EndRevoked();

  size_t size() const { return size_; }
  std::map<std::string, int64_t> ByPrincipal() const;

 private:
  friend class Stream;

  absl::StatusOr<Principal> Authenticate(const Stream& stream) const;
  int64_t CountOf(const std::string& principal) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const Limits& limits_;
  const Authenticator& authenticator_;
  const std::chrono::milliseconds heartbeat_;
  const std::atomic<bool>& draining_;
  mutable Mutex mutex_;
  std::set<Stream*> streams_ ABSL_GUARDED_BY(mutex_);
  std::atomic<size_t> size_ = 0;
};

}  // namespace ballpiston::server
