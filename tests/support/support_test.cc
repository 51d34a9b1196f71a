// Programs that tests start, and the main function of test programs.
#include "tests/support/process.h"
#include "tests/support/scoped_variable.h"

namespace ballpiston {
namespace {

TEST(Process, DiesWithTheThreadThatStartedIt) {
  std::unique_ptr<Process> process;
  std::thread([&] {
    process = std::make_unique<Process>(
        ProcessOptions{.command = {"sh", "-c", "echo started >&2; exec sleep 1000"}});
    process->WaitForErr("started");
  }).join();
  EXPECT_THAT(process->Wait(), ExitsWith(128 + SIGKILL));
}

// More than a pipe holds.
const std::string kLongInput(size_t{1} << 20, 'x');

TEST(Process, LongInputAndOutputDoNotWaitForEachOther) {
  EXPECT_EQ(RunProgram({.command = {"cat"}, .input = kLongInput}).out, kLongInput);
}

TEST(Process, AProgramMayEndWithoutReadingItsInput) {
  EXPECT_THAT(RunProgram({.command = {"true"}, .input = kLongInput}), ExitsWith(0));
}

TEST(Process, AFailedStartIsAnError) {
  const ScopedVariable path("PATH", "/no/such/folder");  // of setpriv
  EXPECT_THAT([] { RunProgram({.command = {"true"}, .input = kLongInput}); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("cannot start true")));
}

TEST(Process, EndsWithinTellsWhetherItRuns) {
  Process process({.command = {"sleep", "1000"}});
  EXPECT_FALSE(process.EndsWithin(std::chrono::milliseconds(0)));
  process.Signal(SIGTERM);
  EXPECT_TRUE(process.EndsWithin(std::chrono::minutes(10)));
  EXPECT_THAT(process.Wait(), ExitsWith(128 + SIGTERM));
}

TEST(TestMain, NamesATestThatTakes15Minutes) {
  EXPECT_GT(alarm(0), 0u);  // the seconds until the alarm
  testing::internal::CaptureStderr();
  raise(SIGALRM);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "[  HANGS?  ] 15 minutes without another test since the start of "
            "TestMain.NamesATestThatTakes15Minutes\n");
}

}  // namespace
}  // namespace ballpiston
