#include "server/api/watch_registry.h"

namespace ballpiston::server {

WatchRegistry::WatchRegistry(std::chrono::milliseconds interval)
    : interval_(interval), thread_([this] { Run(); }) {}

WatchRegistry::~WatchRegistry() { Stop(); }

void WatchRegistry::Add(Watch* watch) {
  std::lock_guard lock(mutex_);
  watches_.insert(watch);
  wake_.notify_one();
}

void WatchRegistry::Remove(Watch* watch) {
  std::lock_guard lock(mutex_);
  watches_.erase(watch);
}

void WatchRegistry::LookNow() {
  std::lock_guard lock(mutex_);
  now_ = true;
  wake_.notify_one();
}

void WatchRegistry::Stop() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
    wake_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
}

size_t WatchRegistry::size() const {
  std::lock_guard lock(mutex_);
  return watches_.size();
}

void WatchRegistry::Run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (watches_.empty()) {
      wake_.wait(lock, [this] { return stopping_ || !watches_.empty(); });
    } else {
      wake_.wait_for(lock, interval_, [this] { return stopping_ || now_; });
    }
    now_ = false;
    const auto now = std::chrono::steady_clock::now();
    for (Watch* watch : watches_) watch->Look(now);
  }
}

}  // namespace ballpiston::server
