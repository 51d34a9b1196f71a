// A disk in memory for SQLite that stops answering when the test says so: its next operation waits.
#pragma once

#include <condition_variable>
#include <mutex>

#include "tests/fault/store/fault_disk.h"
#include "tests/support/await.h"

namespace ballpiston::server {

class HangingDisk {
 public:
  HangingDisk() {
    disk_.SetBeforeOperation([this] { Pass(); });
  }

  void Hang() {
    std::lock_guard lock(mutex_);
    hangs_ = true;
  }
  void AwaitHanging() {
    std::unique_lock lock(mutex_);
    AwaitNotified(changed_, lock, [this] { return waiting_ > 0; });
  }
  void Resume() {
    std::lock_guard lock(mutex_);
    hangs_ = false;
    changed_.notify_all();
  }

 private:
  void Pass() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !hangs_; });
    --waiting_;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool hangs_ = false;
  int waiting_ = 0;
  FaultDisk disk_;
};

}  // namespace ballpiston::server
