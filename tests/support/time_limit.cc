#include "tests/support/time_limit.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
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
  std::string_view program;
  std::string_view suite;
  std::chrono::seconds time;
};

constexpr std::chrono::seconds kUsual(60);
// Measured with ten processes at work on two cores: 60, 46, 24 and 19 s. DiskFailure took 60 s
// under the address sanitizer beside three processes. Conductivity takes 32 s alone.
constexpr Limit kLonger[] = {
    {"end_to_end_test", "BadInputTest", std::chrono::seconds(300)},
    {"slurm_test", "Slurm", std::chrono::seconds(300)},
    {"slurm_test", "Slurm/SlurmControllerKilled", std::chrono::seconds(300)},
    {"statistical_test", "Conductivity", std::chrono::seconds(300)},
    {"store_fault_test", "DiskFailure", std::chrono::seconds(300)},
    {"torture_test", "Kills", std::chrono::seconds(300)},
    {"torture_test", "Overhead", std::chrono::seconds(120)},
    {"torture_test", "StalledReaders", std::chrono::seconds(120)},
};

double TimeScale() {
  const char* const scale = std::getenv("BALLPISTON_TEST_TIME_SCALE");
  return scale == nullptr ? 1 : std::atof(scale);
}

void Write(const std::string& text) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
}

// `report` is made beforehand: a hanging thread may hold the lock of the allocator. Then the alarm
// ends the process, before it has written all stacks. The programs that the tests started end with
// this one (process.h).
[[noreturn]] void Fail(const std::string& report) {
  Write(report);
  alarm(120);
  try {
    WriteThreadStacks(STDERR_FILENO);
  } catch (...) {
    Write("  cannot be read\n");
  }
  _exit(1);
}

// Limits the time of the current test or set-up, or of the program's end. It is never destroyed.
class Watchdog {
 public:
  Watchdog() {
    StartOther("the beginning of the program");
    std::thread([this] { Watch(); }).detach();
  }

  void StartTest(const std::string& name) {
    Start(name, TimeScale() * std::chrono::duration<double>(TimeLimitOf(name)));
  }
  // The time limit is at least the usual one, for every scale.
  void StartOther(const std::string& what) {
    Start(what, std::max(TimeScale(), 1.0) * std::chrono::duration<double>(kUsual));
  }

 private:
  void Start(const std::string& what, std::chrono::duration<double> limit) {
    const std::lock_guard lock(mutex_);
    report_ = absl::StrCat("[  HANGS   ] ", what, " has not ended after ", limit.count(),
                           " s; the stacks of all threads:\n");
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(limit);
    changed_.notify_one();
  }

  void Watch() {
    std::unique_lock lock(mutex_);
    while (true) {
      const Clock::time_point deadline = deadline_;
      changed_.wait_until(lock, deadline);
      if (deadline == deadline_ && Clock::now() >= deadline) Fail(report_);
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::string report_;
  Clock::time_point deadline_;
};

class WatchedTests : public testing::EmptyTestEventListener {
 public:
  void OnTestStart(const testing::TestInfo& test) override {
    watchdog_.StartTest(absl::StrCat(test.test_suite_name(), ".", test.name()));
  }
  void OnTestEnd(const testing::TestInfo&) override { watchdog_.StartOther("a set-up"); }
  void OnTestProgramEnd(const testing::UnitTest&) override {
    watchdog_.StartOther("the end of the program");
  }

 private:
  Watchdog& watchdog_ = *new Watchdog;
};

bool HasSuite(std::string_view name) {
  const testing::UnitTest& tests = *testing::UnitTest::GetInstance();
  for (int i = 0; i < tests.total_test_suite_count(); ++i) {
    if (tests.GetTestSuite(i)->name() == name) return true;
  }
  return false;
}

// Finds rows whose suite does not exist any more, for example after a rename.
void CheckRowsOf(std::string_view program) {
  for (const Limit& limit : kLonger) {
    if (!program.ends_with(limit.program) || HasSuite(limit.suite)) continue;
    std::cerr << "time_limit.cc has a row for " << limit.suite << ", which " << program
              << " has not\n";
    std::exit(1);
  }
}

}  // namespace

std::chrono::seconds TimeLimitOf(std::string_view test) {
  const std::string_view suite = test.substr(0, test.find('.'));
  for (const Limit& limit : kLonger) {
    if (suite == limit.suite) return limit.time;
  }
  return kUsual;
}

void LimitTestTimes(const char* program) {
  CheckRowsOf(program);
  absl::InitializeSymbolizer(program);
  testing::UnitTest::GetInstance()->listeners().Append(new WatchedTests);  // gtest owns it
}

}  // namespace ballpiston
