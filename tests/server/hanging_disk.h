// A file system for SQLite that stops answering when the test says so: writes to logs wait.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

namespace ballpiston::server {

class HangingDisk {
 public:
  HangingDisk();
  ~HangingDisk();  // no connection may be left
  HangingDisk(const HangingDisk&) = delete;
  HangingDisk& operator=(const HangingDisk&) = delete;

  const std::string& vfs() const { return name_; }

  void Hang();          // from the next write on
  void AwaitHanging();  // until a write waits
  void Resume();

 private:
  struct Vfs;

  void Pass();

  const std::string name_;
  std::unique_ptr<Vfs> registered_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool hangs_ = false;
  int waiting_ = 0;
};

}  // namespace ballpiston::server
