#include "server/api/held_calls.h"

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

absl::Status TooManyCalls(const std::string& what, const std::string& flag, int64_t limit) {
  return LimitExceeded("TOO_MANY_CALLS", what, flag, static_cast<double>(limit));
}

absl::Status TooManyBytes(const std::string& principal, int64_t bytes, int64_t limit) {
  return TooManyCalls(
      absl::StrCat(principal, " has ", bytes, " bytes in calls in progress and unread answers"),
      "max-call-bytes-per-principal", limit);
}

}  // namespace

absl::Status HeldCalls::Begin(const std::string& principal, int64_t bytes, const Limits& limits) {
  MutexLock lock(mutex_);
  Held& held = held_[principal];
  const int64_t most_calls = limits.max_calls_per_principal;
  const int64_t most_bytes = limits.max_call_bytes_per_principal;
  if (most_calls > 0 && held.calls >= most_calls) {
    return TooManyCalls(absl::StrCat(principal, " has ", held.calls, " calls in progress"),
                        "max-calls-per-principal", most_calls);
  }
  if (most_bytes > 0 && held.calls > 0 && held.bytes + bytes > most_bytes) {
    return TooManyBytes(principal, held.bytes + bytes, most_bytes);
  }
  ++held.calls;
  held.bytes += bytes;
  return absl::OkStatus();
}

absl::Status HeldCalls::CheckRoom(const std::string& principal, const Limits& limits) const {
  MutexLock lock(mutex_);
  const auto held = held_.find(principal);
  const int64_t most = limits.max_call_bytes_per_principal;
  const bool has_room =
      most == 0 || held == held_.end() || held->second.calls < 2 || held->second.bytes <= most;
  return has_room ? absl::OkStatus() : TooManyBytes(principal, held->second.bytes, most);
}

void HeldCalls::AddBytes(const std::string& principal, int64_t bytes) {
  MutexLock lock(mutex_);
  held_[principal].bytes += bytes;
}

bool HeldCalls::TryBegin(const std::string& principal, int64_t bytes, int64_t limit) {
  MutexLock lock(mutex_);
  const auto held = held_.try_emplace(principal).first;
  if (held->second.calls > 0 && held->second.bytes + bytes > limit) return false;
  ++held->second.calls;
  held->second.bytes += bytes;
  return true;
}

void HeldCalls::End(const std::string& principal, int64_t bytes) {
  MutexLock lock(mutex_);
  const auto held = held_.find(principal);
  if (held == held_.end()) return;
  held->second.bytes -= bytes;
  if (--held->second.calls == 0) held_.erase(held);
}

}  // namespace ballpiston::server
