#include "tests/support/watchdog.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"

namespace ballpiston {
namespace {

using Clock = std::chrono::steady_clock;

std::chrono::duration<double> Patience() {
  const char* const seconds = std::getenv("BALLPISTON_HANGS_AFTER");
  return std::chrono::duration<double>(seconds == nullptr ? 15 * 60 : std::atof(seconds));
}

void Write(const std::string& text) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
}

// Watches the current test or set-up, or the program's end. It is never destroyed.
class Watchdog {
 public:
  Watchdog() {
    Start("the beginning of the program");
    std::thread([this] { Watch(); }).detach();
  }

  void Start(const std::string& what) {
    const std::lock_guard lock(mutex_);
    // Made beforehand, because a hanging thread may hold the allocator's lock.
    report_ = absl::StrCat("[  HANGS?  ] ", what, " has not ended after ", patience_.count(),
                           " s or more\n");
    SetDeadline();
    changed_.notify_one();
  }

 private:
  void Watch() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait_until(lock, deadline_);
      if (Clock::now() < deadline_) continue;
      Write(report_);
      SetDeadline();
    }
  }

  void SetDeadline() {
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(patience_);
  }

  const std::chrono::duration<double> patience_ = Patience();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string report_;
  Clock::time_point deadline_;
};

class WatchedTests : public testing::EmptyTestEventListener {
 public:
  void OnTestStart(const testing::TestInfo& test) override {
    watchdog_.Start(absl::StrCat(test.test_suite_name(), ".", test.name()));
  }
  void OnTestEnd(const testing::TestInfo&) override { watchdog_.Start("a set-up"); }
  void OnTestProgramEnd(const testing::UnitTest&) override {
    watchdog_.Start("the end of the program");
  }

 private:
  Watchdog& watchdog_ = *new Watchdog;
};

}  // namespace

void WatchTests() {
  testing::UnitTest::GetInstance()->listeners().Append(new WatchedTests);  // gtest owns it
}

}  // namespace ballpiston
