#include "server/api/watch_registry.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

// A look at a thousand watches takes some 0.1 ms.
constexpr std::chrono::milliseconds kShortestInterval(2);

bool IsFull(int64_t streams, int64_t limit) { return limit != 0 && streams >= limit; }

absl::Status TooManyStreams(const std::string& what, const std::string& flag, int64_t limit) {
  return LimitExceeded("TOO_MANY_STREAMS", absl::StrCat(what, " open streams"), flag,
                       static_cast<double>(limit));
}

}  // namespace

WatchRegistry::WatchRegistry(std::chrono::milliseconds interval)
    : interval_(interval), thread_([this] { Run(); }) {}

WatchRegistry::~WatchRegistry() { Stop(); }

absl::Status WatchRegistry::Add(Watch* watch, const std::string& principal, const Limits& limits) {
  MutexLock lock(mutex_);
  const auto all = static_cast<int64_t>(watches_.size());
  if (IsFull(all, limits.max_streams)) {
    return TooManyStreams(absl::StrCat("there are ", all), "max-streams", limits.max_streams);
  }
  const auto found = streams_.find(principal);
  const int64_t own = found == streams_.end() ? 0 : found->second;
  if (IsFull(own, limits.max_streams_per_principal)) {
    return TooManyStreams(absl::StrCat(principal, " has ", own), "max-streams-per-principal",
                          limits.max_streams_per_principal);
  }
  watches_.emplace(watch, principal);
  streams_[principal] = own + 1;
  size_ = watches_.size();
  wake_.NotifyOne();
  return absl::OkStatus();
}

void WatchRegistry::Remove(Watch* watch) {
  MutexLock lock(mutex_);
  const auto found = watches_.find(watch);
  if (found == watches_.end()) return;
  const auto streams = streams_.find(found->second);
  if (--streams->second == 0) streams_.erase(streams);
  watches_.erase(found);
  size_ = watches_.size();
}

void WatchRegistry::LookNow() {
  MutexLock lock(mutex_);
  now_ = true;
  wake_.NotifyOne();
}

void WatchRegistry::Stop() {
  {
    MutexLock lock(mutex_);
    stopping_ = true;
    wake_.NotifyOne();
  }
  if (thread_.joinable()) thread_.join();
}

std::map<std::string, int64_t> WatchRegistry::StreamsByPrincipal() const {
  MutexLock lock(mutex_);
  return streams_;
}

void WatchRegistry::AwaitLook(Clock::time_point last) {
  const Clock::time_point earliest = last + std::min(kShortestInterval, interval_);
  while (!stopping_ && wake_.WaitUntil(mutex_, earliest)) continue;
  while (!stopping_ && watches_.empty()) wake_.Wait(mutex_);
  while (!stopping_ && !now_ && wake_.WaitUntil(mutex_, last + interval_)) continue;
}

void WatchRegistry::Run() {
  MutexLock lock(mutex_);
  Clock::time_point last = Clock::now();
  while (!stopping_) {
    AwaitLook(last);
    now_ = false;
    last = Clock::now();
    for (const auto& [watch, whose] : watches_) watch->Look(last);
  }
}

}  // namespace ballpiston::server
