// How many calls of each method began and ended, with which code, and how long they took.
//
// Counting is a few relaxed atomic additions; a method is looked up once a call. Methods are those
// that the server has registered: their number is bounded. Thread-safe.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_CALL_STATISTICS_H_
#define BALLPISTON_SERVER_OBSERVABILITY_CALL_STATISTICS_H_

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <shared_mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

inline constexpr size_t kStatusCodes = 17;  // 0 (OK) to 16 (UNAUTHENTICATED)

// Upper bounds, in seconds, of the classes that durations fall into; there is one more, unbounded.
inline constexpr std::array<double, 10> kDurationBounds = {0.001, 0.003, 0.01, 0.03, 0.1,
                                                           0.3,   1,     3,    10,   30};

class MethodCounts {
 public:
  // `path` is /PACKAGE.SERVICE/METHOD; `type` unary, client_stream, server_stream or bidi_stream.
  MethodCounts(absl::string_view path, absl::string_view type);

  void Began() { began_.fetch_add(1, std::memory_order_relaxed); }
  void Ended(absl::StatusCode code, double seconds);

  struct Totals {
    std::string service;
    std::string method;
    std::string type;
    uint64_t began = 0;
    std::array<uint64_t, kStatusCodes> ended = {};                    // by code
    std::array<uint64_t, kDurationBounds.size() + 1> durations = {};  // by class
    double seconds = 0;
  };
  Totals Read() const;

 private:
  using Count = std::atomic<uint64_t>;

  Totals zero_;  // the names
  Count began_ = 0;
  std::array<Count, kStatusCodes> ended_ = {};
  std::array<Count, kDurationBounds.size() + 1> durations_ = {};
  std::atomic<double> seconds_ = 0;
};

class CallStatistics {
 public:
  // Lives as long as this. What it is called by first decides the type.
  MethodCounts& Of(absl::string_view path, absl::string_view type);

  // The methods of a service of the generated protos, so that they are told of before they are
  // called for the first time.
  void Expect(const std::string& service);

  std::vector<MethodCounts::Totals> Read() const;  // ordered by path

 private:
  mutable std::shared_mutex mutex_;
  std::map<std::string, std::unique_ptr<MethodCounts>, std::less<>> methods_;  // by path
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_CALL_STATISTICS_H_
