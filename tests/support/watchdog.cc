#include "tests/support/watchdog.h"

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "gtest/gtest.h"

namespace ballpiston {
namespace {

// The signal handler prints this text, because a handler may not allocate.
char report[500];

void PrintReport(int) {
  const int before = errno;
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, report, std::strlen(report));
  errno = before;
}

// From now on the timer reports that `what` has not ended.
void Watch(const std::string& what) {
  const char* const given = std::getenv("BALLPISTON_HANGS_AFTER");
  const double seconds = given == nullptr ? 15 * 60 : std::atof(given);
  const itimerval off = {};
  setitimer(ITIMER_REAL, &off, nullptr);
  std::snprintf(report, sizeof(report), "[  HANGS?  ] %s has not ended after %g s or more\n",
                what.c_str(), seconds);
  const auto whole = static_cast<time_t>(seconds);
  const timeval time = {whole,
                        static_cast<suseconds_t>(1e6 * (seconds - static_cast<double>(whole)))};
  const itimerval again_and_again = {.it_interval = time, .it_value = time};
  setitimer(ITIMER_REAL, &again_and_again, nullptr);
}

class WatchedTests : public testing::EmptyTestEventListener {
 public:
  void OnTestStart(const testing::TestInfo& test) override {
    Watch(std::string(test.test_suite_name()) + "." + test.name());
  }
  void OnTestEnd(const testing::TestInfo&) override { Watch("a set-up"); }
  void OnTestProgramEnd(const testing::UnitTest&) override { Watch("the end of the program"); }
};

}  // namespace

void WatchTests() {
  struct sigaction action = {};
  action.sa_handler = PrintReport;
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, nullptr);
  Watch("the beginning of the program");
  testing::UnitTest::GetInstance()->listeners().Append(new WatchedTests);  // gtest owns it
}

}  // namespace ballpiston
