#include "tests/support/time_limit.h"

#include <signal.h>
#include <unistd.h>

#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <fstream>
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
  std::string_view tests;  // names that begin so
  std::chrono::seconds time;
};

constexpr std::chrono::seconds kUsual(60);
constexpr Limit kLonger[] = {
    {"", kUsual},
};

double TimeScale() {
  const char* const scale = std::getenv("BALLPISTON_TEST_TIME_SCALE");
  return scale == nullptr ? 1 : std::atof(scale);
}

void KillChildren() {
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;) kill(child, SIGKILL);
  }
}

[[noreturn]] void Fail(const std::string& test, double seconds) {
  std::cerr << absl::StrCat("[  HANGS   ] ", test, " has not ended after ", seconds,
                            " s; the stacks of all threads:\n",
                            ThreadStacks(), "[  FAILED  ] ", test, "\n")
            << std::flush;
  KillChildren();
  _exit(1);
}

class TestClock : public testing::EmptyTestEventListener {
 public:
  TestClock() { std::thread([this] { Watch(); }).detach(); }

  void OnTestStart(const testing::TestInfo& test) override {
    const std::string name = absl::StrCat(test.test_suite_name(), ".", test.name());
    Start(name, TimeLimitOf(name));
  }
  void OnTestEnd(const testing::TestInfo&) override { Start("between two tests", kUsual); }
  void OnTestProgramEnd(const testing::UnitTest&) override {
    Start("the end of the program", kUsual);
  }

 private:
  void Start(const std::string& name, std::chrono::seconds limit) {
    const std::lock_guard lock(mutex_);
    name_ = name;
    seconds_ = TimeScale() * static_cast<double>(limit.count());
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(seconds_));
    changed_.notify_one();
  }

  void Watch() {
    std::unique_lock lock(mutex_);
    while (true) {
      const Clock::time_point deadline = deadline_;
      changed_.wait_until(lock, deadline);
      if (deadline == deadline_ && Clock::now() >= deadline) Fail(name_, seconds_);
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::string name_ = "the beginning of the program";
  double seconds_ = static_cast<double>(kUsual.count());
  Clock::time_point deadline_ = Clock::now() + kUsual;
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
  testing::UnitTest::GetInstance()->listeners().Append(new TestClock);  // gtest owns it
}

}  // namespace ballpiston
