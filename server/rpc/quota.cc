#include "server/rpc/quota.h"

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"

namespace ballpiston::server {

absl::StatusOr<Quota::Part> Quota::Take(const std::string& principal, int64_t amount) {
  {
    MutexLock lock(mutex_);
    const auto own = principals_.find(principal);
    const int64_t taken = own == principals_.end() ? 0 : own->second;
    absl::Status fits = Check("all clients", taken_ + amount, rule_.all);
    if (fits.ok()) fits = Check(principal, taken + amount, rule_.of_one);
    if (!fits.ok()) return fits;
    Count(principal, amount);
  }
  // If memory runs out, shared_ptr gives the part back.
  return Part(nullptr, [this, principal, amount](void*) {
    MutexLock lock(mutex_);
    Count(principal, -amount);
  });
}

absl::Status Quota::Check(const std::string& user, int64_t amount, const Limit& limit) const {
  if (limit.most == 0 || amount <= limit.most) return absl::OkStatus();
  return LimitExceeded(rule_.reason, absl::StrCat(user, " would have ", amount, " ", rule_.what),
                       limit.flag, static_cast<double>(limit.most));
}

void Quota::Count(const std::string& principal, int64_t amount) {
  taken_ += amount;
  if ((principals_[principal] += amount) == 0) principals_.erase(principal);
}

int64_t Quota::taken() const {
  MutexLock lock(mutex_);
  return taken_;
}

std::map<std::string, int64_t> Quota::ByPrincipal() const {
  MutexLock lock(mutex_);
  return principals_;
}

void Turns::Await(int most) {
  MutexLock lock(mutex_);
  const int64_t own = asked_++;
  while (own >= ended_ + most) ended_one_.Wait(mutex_);
}

void Turns::End() {
  MutexLock lock(mutex_);
  ++ended_;
  ended_one_.NotifyAll();
}

Quotas::Quotas(const Limits& limits)
    : calls({.what = "MiB in calls in progress and unread answers (a call counts as 2, or five "
                     "times its request; a stream of collisions as 48)",
             .reason = "TOO_MANY_CALLS",
             .of_one = {kMostMibOfCalls}}),
      streams({.what = "open streams",
               .reason = "TOO_MANY_STREAMS",
               .all = {MostStreams(limits), "max-streams"},
               .of_one = {limits.max_streams_per_principal, "max-streams-per-principal"}}) {}

}  // namespace ballpiston::server
