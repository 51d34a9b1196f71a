// Watches how long the disk takes to answer a connection that writes.
//
// A transaction may take long. But if a single disk call (a read, a write, a flush) takes seconds,
// the disk hangs. SQLite does not report its disk calls, so this class replaces their functions in
// its files. Other calls of the same thread are marked (Mark).
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <vector>

#include "server/host.h"

struct sqlite3_file;

namespace ballpiston::server {

class DiskCalls {
 public:
  using Clock = std::chrono::steady_clock;

  DiskCalls();
  ~DiskCalls();
  DiskCalls(const DiskCalls&) = delete;
  DiskCalls& operator=(const DiskCalls&) = delete;

  // This must outlive the file's connection. The file's writes pass `failpoint`, if there is one.
  void Watch(sqlite3_file& file, const char* failpoint = nullptr);

  // A disk call lasts as long as this lives.
  class Mark {
   public:
    explicit Mark(DiskCalls& calls) : calls_(calls) {
      calls_.begin_ = SteadyNow().time_since_epoch().count();
    }
    ~Mark() { calls_.begin_ = 0; }
    Mark(const Mark&) = delete;
    Mark& operator=(const Mark&) = delete;

   private:
    DiskCalls& calls_;
  };

  // How long the current disk call has taken; 0 between calls. Thread-safe.
  Clock::duration Waiting() const;

 private:
  struct Methods;
  class Call;

  std::vector<std::unique_ptr<Methods>> methods_;  // of the watched files
  std::atomic<Clock::rep> begin_ = 0;              // of the current call; 0: none
};

}  // namespace ballpiston::server
