#include "tests/support/time_limit.h"

#include <unistd.h>

#include <condition_variable>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>

#include "absl/debugging/symbolize.h"
#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "tests/support/thread_stacks.h"

namespace ballpiston {
namespace {

using Clock = std::chrono::steady_clock;

struct Limit {
  std::string_view tests;  // the beginning of their full names
  std::chrono::seconds time;
};

constexpr std::chrono::seconds kUsual(60);
// Measured with ten processes at work on two cores: 60, 46, 24 and 19 s.
constexpr Limit kLonger[] = {
    {"BadInputTest.", std::chrono::seconds(300)},
    {"Kills.", std::chrono::seconds(300)},
    {"Overhead.", std::chrono::seconds(120)},
    {"StalledReaders.", std::chrono::seconds(120)},
};

double TimeScale() {
  const char* const scale = std::getenv("BALLPISTON_TEST_TIME_SCALE");
  return scale == nullptr ? 1 : std::atof(scale);
}

[[noreturn]] void Fail(const std::string& test, double seconds) {
  std::cerr << absl::StrCat("[  HANGS   ] ", test, " has not ended after ", seconds,
                            " s; the stacks of all threads:\n", ThreadStacks(), "[  FAILED  ] ",
                            test, "\n")
            << std::flush;
  _exit(1);  // child processes end with this one (process.h)
}

// Limits the time of the current test or set-up, or of the program's end. It is never destroyed.
class Watchdog {
 public:
  Watchdog() {
    Start("the beginning of the program", kUsual);
    std::thread([this] { Watch(); }).detach();
  }

  void Start(const std::string& what, std::chrono::seconds limit) {
    const std::lock_guard lock(mutex_);
    what_ = what;
    seconds_ = TimeScale() * static_cast<double>(limit.count());
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(seconds_));
    changed_.notify_one();
  }

 private:
  void Watch() {
    std::unique_lock lock(mutex_);
    while (true) {
      const Clock::time_point deadline = deadline_;
      changed_.wait_until(lock, deadline);
      if (deadline == deadline_ && Clock::now() >= deadline) Fail(what_, seconds_);
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::string what_;
  double seconds_ = 0;
  Clock::time_point deadline_;
};

class WatchedTests : public testing::EmptyTestEventListener {
 public:
  void OnTestStart(const testing::TestInfo& test) override {
    const std::string name = absl::StrCat(test.test_suite_name(), ".", test.name());
    watchdog_.Start(name, TimeLimitOf(name));
  }
  void OnTestEnd(const testing::TestInfo&) override { watchdog_.Start("a set-up", kUsual); }
  void OnTestProgramEnd(const testing::UnitTest&) override {
    watchdog_.Start("the end of the program", kUsual);
  }

 private:
  Watchdog& watchdog_ = *new Watchdog;
};

}  // namespace

std::chrono::seconds TimeLimitOf(std::string_view test) {
  for (const Limit& limit : kLonger) {
    if (test.starts_with(limit.tests)) return limit.time;
  }
  return kUsual;
}

void LimitTestTimes(const char* program) {
  absl::InitializeSymbolizer(program);
  testing::UnitTest::GetInstance()->listeners().Append(new WatchedTests);  // gtest owns it
}

}  // namespace ballpiston
