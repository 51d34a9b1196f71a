#include "server/api/open_calls.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

absl::Status TooMany(const std::string& what, const std::string& flag, int64_t limit) {
  return LimitExceeded("TOO_MANY_CALLS", what, flag, static_cast<double>(limit));
}

}  // namespace

absl::StatusOr<std::shared_ptr<OpenCalls::Call>> OpenCalls::Begin(const std::string& principal,
                                                                  int64_t bytes) {
  // Before the lock: if memory runs out, nothing is counted. A rejected call ends after the lock.
  const std::shared_ptr<Call> call(new Call(*this, principal));
  MutexLock lock(mutex_);
  Held& held = held_[principal];
  const int64_t most_calls = limits_.max_calls_per_principal;
  const int64_t most_bytes = limits_.max_call_bytes_per_principal;
  if (most_calls > 0 && held.calls >= most_calls) {
    return TooMany(absl::StrCat(principal, " has ", held.calls, " calls in progress"),
                   "max-calls-per-principal", most_calls);
  }
  if (most_bytes > 0 && held.calls > 0 && held.bytes + bytes > most_bytes) {
    return TooMany(absl::StrCat(principal, " has ", held.bytes + bytes,
                                " bytes in calls in progress and unread answers"),
                   "max-call-bytes-per-principal", most_bytes);
  }
  ++held.calls;
  held.bytes += bytes;
  call->bytes_ = bytes;
  return call;
}

OpenCalls::Call::Call(OpenCalls& all, std::string principal)
    : all_(all), principal_(std::move(principal)) {}

void OpenCalls::Call::AddBytes(int64_t bytes) {
  MutexLock lock(all_.mutex_);
  *bytes_ += bytes;
  all_.held_[principal_].bytes += bytes;
}

OpenCalls::Call::~Call() {
  if (!bytes_) return;
  MutexLock lock(all_.mutex_);
  const auto held = all_.held_.find(principal_);
  held->second.bytes -= *bytes_;
  if (--held->second.calls == 0) all_.held_.erase(held);
}

}  // namespace ballpiston::server
