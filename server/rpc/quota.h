// A quota limits how much the principals use at the same time, such as streams. Its limits keep one
// principal from using the whole server. Thread-safe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/limits.h"
#include "server/mutex.h"

namespace ballpiston::server {

class Quota {
 public:
  struct Limit {
    int64_t most = 0;  // 0: no limit
    const char* flag = "";
  };
  struct Rule {
    const char* what = "";    // is counted, in the plural
    const char* reason = "";  // of the error
    Limit all = {};           // of all principals together
    Limit of_one = {};        // of each principal
  };

  // An amount that a call uses. The quota gets it back when the last copy of the part is destroyed.
  // The quota must outlive its parts.
  using Part = std::shared_ptr<void>;

  explicit Quota(Rule rule) : rule_(rule) {}

  // RESOURCE_EXHAUSTED beyond a limit.
  absl::StatusOr<Part> Take(const std::string& principal, int64_t amount = 1);

  int64_t taken() const;
  std::map<std::string, int64_t> ByPrincipal() const;

 private:
  absl::Status Check(const std::string& user, int64_t amount, const Limit& limit) const;
  void Count(const std::string& principal, int64_t amount) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const Rule rule_;
  mutable Mutex mutex_;
  int64_t taken_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::string, int64_t> principals_ ABSL_GUARDED_BY(mutex_);
};

// Lets so many threads compute at a time; the others wait, first come, first served.
class Turns {
 public:
  void Await(int most);
  void End();

 private:
  Mutex mutex_;
  Condition ended_one_;
  int64_t asked_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t ended_ ABSL_GUARDED_BY(mutex_) = 0;
};

// The memory, in MiB, of most requests with their answers, and of a trace with its messages.
inline constexpr int64_t kMibOfCall = 2;
// The memory, in MiB, of a call whose request has so many bytes. A large request is copied into a
// specification and a record: four times its bytes were measured.
constexpr int64_t MibOfCall(size_t request_bytes) {
  return std::max(kMibOfCall, static_cast<int64_t>(5 * request_bytes >> 20));
}
// The limit of one principal. It permits 128 calls, 12 of the largest, or 5 samplers
// (kMibOfSampler).
inline constexpr int64_t kMostMibOfCalls = 256;

// The quotas of all methods.
struct Quotas {
  explicit Quotas(const Limits& limits);

  // MiB of the unary calls in progress, of traces and of samplers. A unary call counts until the
  // client has received its answer. Until then the answer keeps memory and a thread. Without this
  // limit a client that does not read its answers could use up both.
  Quota calls;
  // Watches and traces. Each has a thread.
  Quota streams;
  // Traces and samplers compute in turns, because they compute beside the threads for jobs.
  Turns traces;
};

}  // namespace ballpiston::server
