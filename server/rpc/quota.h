// A quota limits how many calls, bytes, streams or turns the principals use at the same time. Its
// limits keep one principal from using the whole server. Thread-safe.
#pragma once

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

  // RESOURCE_EXHAUSTED beyond a limit. The only part of a principal may have any amount.
  absl::StatusOr<Part> Take(std::string principal, int64_t amount = 1);
  // The same without limits.
  Part TakeAnyway(std::string principal, int64_t amount);
  // Takes one when the limits permit it.
  Part Await(std::string principal);

  int64_t taken() const;
  std::map<std::string, int64_t> ByPrincipal() const;

 private:
  struct OfPrincipal {
    int64_t taken = 0;
    int64_t waiting = 0;
    Condition changed;  // one for each principal: a part that is given back wakes a call of each
  };

  // The limit that would be exceeded; null: none.
  const Limit* Exceeded(const std::string& principal, int64_t amount)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::Status TooMany(const std::string& principal, int64_t amount, const Limit& limit)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Count(const std::string& principal, int64_t amount) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  Part PartOf(std::string principal, int64_t amount);  // that is counted

  const Rule rule_;
  mutable Mutex mutex_;
  int64_t taken_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::string, OfPrincipal> principals_ ABSL_GUARDED_BY(mutex_);
};

// The quotas of all methods.
struct Quotas {
  explicit Quotas(const Limits& limits);

  // Unary calls in progress, and their memory: the request, and the answer until the client has
  // received it, or what a trace computes. So a client that does not read the answers of its calls
  // reaches the limits.
  Quota calls;
  Quota call_bytes;
  // Watches and traces. Each has a thread.
  Quota streams;
  // Calls that compute. Each call has a thread, so a principal with many calls would slow down the
  // calls of all others, and the workers.
  Quota turns;
};

}  // namespace ballpiston::server
