// All open streams, and the one thread that calls them.
//
// The thread calls Look of each stream a few times a second, and at once when a job changes its
// state, but at most once in a few milliseconds. A stream that has something to send then schedules
// its next message. The registry also counts the streams of each principal. Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "server/limits.h"
#include "server/mutex.h"

namespace ballpiston::server {

class Watch {
 public:
  virtual ~Watch() = default;
  // Must be quick and must not call the registry.
  virtual void Look(std::chrono::steady_clock::time_point now) = 0;
};

class WatchRegistry {
 public:
  // `interval`: between two calls of Look.
  explicit WatchRegistry(std::chrono::milliseconds interval);
  ~WatchRegistry();  // stops

  // RESOURCE_EXHAUSTED, TOO_MANY_STREAMS: the registry did not add the stream.
  absl::Status Add(Watch* watch, const std::string& principal, const Limits& limits);
  // When this returns, the stream is not called any more. No effect if the stream was not added.
  void Remove(Watch* watch);

  // Calls Look of all watches soon.
  void LookNow();

  void Stop();

  size_t size() const { return size_; }
  std::map<std::string, int64_t> StreamsByPrincipal() const;

 private:
  using Clock = std::chrono::steady_clock;

  void Run();
  void AwaitLook(Clock::time_point last) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::chrono::milliseconds interval_;
  mutable Mutex mutex_;
  Condition wake_;
  std::map<Watch*, std::string> watches_ ABSL_GUARDED_BY(mutex_);  // the principal of each
  std::map<std::string, int64_t> streams_ ABSL_GUARDED_BY(mutex_);
  std::atomic<size_t> size_ = 0;
  bool now_ ABSL_GUARDED_BY(mutex_) = false;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace ballpiston::server
