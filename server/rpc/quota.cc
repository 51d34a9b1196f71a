#include "server/rpc/quota.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

constexpr int64_t kTurns = 8;

bool IsBeyond(const Quota::Limit& limit, int64_t amount) {
  return limit.most > 0 && amount > limit.most;
}

}  // namespace

absl::StatusOr<Quota::Part> Quota::Take(std::string principal, int64_t amount) {
  {
    MutexLock lock(mutex_);
    const Limit* const limit = Exceeded(principal, amount);
    if (limit != nullptr) return TooMany(principal, amount, *limit);
    Count(principal, amount);
  }
  return PartOf(std::move(principal), amount);
}

Quota::Part Quota::TakeAnyway(std::string principal, int64_t amount) {
  {
    MutexLock lock(mutex_);
    Count(principal, amount);
  }
  return PartOf(std::move(principal), amount);
}

Quota::Part Quota::Await(std::string principal) {
  {
    MutexLock lock(mutex_);
    OfPrincipal& own = principals_[principal];
    ++own.waiting;
    while (Exceeded(principal, 1) != nullptr) own.changed.Wait(mutex_);
    --own.waiting;
    Count(principal, 1);
  }
  return PartOf(std::move(principal), 1);
}

const Quota::Limit* Quota::Exceeded(const std::string& principal, int64_t amount) {
  if (IsBeyond(rule_.all, taken_ + amount)) return &rule_.all;
  const int64_t own = principals_[principal].taken;
  return own > 0 && IsBeyond(rule_.of_one, own + amount) ? &rule_.of_one : nullptr;
}

absl::Status Quota::TooMany(const std::string& principal, int64_t amount, const Limit& limit) {
  const bool is_of_one = &limit == &rule_.of_one;
  const int64_t taken = is_of_one ? principals_[principal].taken : taken_;
  return LimitExceeded(rule_.reason,
                       absl::StrCat(is_of_one ? principal : "all clients", " would have ",
                                    taken + amount, " ", rule_.what),
                       limit.flag, static_cast<double>(limit.most));
}

void Quota::Count(const std::string& principal, int64_t amount) {
  taken_ += amount;
  OfPrincipal& own = principals_[principal];
  own.taken += amount;
  if (own.taken == 0 && own.waiting == 0) principals_.erase(principal);
}

// If memory runs out, shared_ptr gives the part back.
Quota::Part Quota::PartOf(std::string principal, int64_t amount) {
  return Part(nullptr, [this, principal = std::move(principal), amount](void*) {
    MutexLock lock(mutex_);
    Count(principal, -amount);
    for (auto& [name, other] : principals_) other.changed.NotifyOne();
  });
}

int64_t Quota::taken() const {
  MutexLock lock(mutex_);
  return taken_;
}

std::map<std::string, int64_t> Quota::ByPrincipal() const {
  MutexLock lock(mutex_);
  std::map<std::string, int64_t> taken;
  for (const auto& [name, principal] : principals_) taken[name] = principal.taken;
  return taken;
}

Quotas::Quotas(const Limits& limits)
    : calls({.what = "calls in progress",
             .reason = "TOO_MANY_CALLS",
             .of_one = {limits.max_calls_per_principal, "max-calls-per-principal"}}),
      call_bytes({.what = "bytes in calls in progress and unread answers",
                  .reason = "TOO_MANY_CALLS",
                  .of_one = {limits.max_call_bytes_per_principal, "max-call-bytes-per-principal"}}),
      streams({.what = "open streams",
               .reason = "TOO_MANY_STREAMS",
               .all = {MostStreams(limits), "max-streams"},
               .of_one = {limits.max_streams_per_principal, "max-streams-per-principal"}}),
      turns({.all = {kTurns}, .of_one = {kTurns / 2}}) {}

}  // namespace ballpiston::server
