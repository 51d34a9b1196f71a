#include "tests/support/run_tests.h"

#include <sys/resource.h>

#include "absl/strings/str_format.h"
#include "gmock/gmock.h"
#include "tests/support/watchdog.h"

namespace ballpiston {
namespace {

double ProcessorSeconds(int who) {
  rusage usage = {};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Of this process and of the programs that it started and that have ended.
double ProcessorSeconds() {
  return ProcessorSeconds(RUSAGE_SELF) + ProcessorSeconds(RUSAGE_CHILDREN);
}

class ProcessorTimes : public testing::EmptyTestEventListener {
 public:
  void OnTestStart(const testing::TestInfo&) override { start_ = ProcessorSeconds(); }
  void OnTestEnd(const testing::TestInfo&) override {
    testing::Test::RecordProperty("processor_seconds",
                                  absl::StrFormat("%.2f", ProcessorSeconds() - start_));
  }

 private:
  double start_ = 0;
};

}  // namespace

int RunTests(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  // A forked copy of a process with threads may hang: another thread may hold the allocator's lock.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  WatchTests();
  testing::UnitTest::GetInstance()->listeners().Append(new ProcessorTimes);  // gtest owns it
  return RUN_ALL_TESTS();
}

}  // namespace ballpiston
