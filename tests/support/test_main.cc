// The main function of all test programs.
//
// The test report (--gtest_output) has the processor time of each test, with that of the programs
// that it started, as the property "processor_seconds". If a test takes 15 minutes, the program
// prints the test's name, because with --gtest_brief=1 no other line names a test that hangs. The
// test goes on.
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "absl/strings/str_format.h"
#include "gmock/gmock.h"

namespace ballpiston {
namespace {

constexpr unsigned kMinutes = 15;

// The handler of SIGALRM prints this text, because a handler may not allocate.
char last_test[500];

void PrintLastTest(int) {
  const int before = errno;
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, last_test, std::strlen(last_test));
  errno = before;
}

double ProcessorSeconds(int who) {
  rusage usage = {};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// The processor time of this process and of its children that have ended.
double ProcessorSeconds() {
  return ProcessorSeconds(RUSAGE_SELF) + ProcessorSeconds(RUSAGE_CHILDREN);
}

class TestTimes : public testing::EmptyTestEventListener {
 public:
  void OnTestStart(const testing::TestInfo& test) override {
    alarm(0);
    std::snprintf(last_test, sizeof(last_test),
                  "[  HANGS?  ] %u minutes without another test since the start of %s.%s\n",
                  kMinutes, test.test_suite_name(), test.name());
    alarm(60 * kMinutes);
    start_ = ProcessorSeconds();
  }
  void OnTestEnd(const testing::TestInfo&) override {
    testing::Test::RecordProperty("processor_seconds",
                                  absl::StrFormat("%.2f", ProcessorSeconds() - start_));
  }

 private:
  double start_ = 0;
};

}  // namespace
}  // namespace ballpiston

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  // A forked copy of a process with threads may hang: another thread may hold the allocator's lock.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  struct sigaction action = {};
  action.sa_handler = ballpiston::PrintLastTest;
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, nullptr);
  // GoogleTest owns the listener.
  testing::UnitTest::GetInstance()->listeners().Append(new ballpiston::TestTimes);
  return RUN_ALL_TESTS();
}
