#include "client/library/child_process.h"

#include <signal.h>

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

class ChildProcessTest : public ::testing::Test {
 protected:
  int RunShell(const std::string& script) const {
    const auto status = RunChild({.command = {"sh", "-c", script},
                                  .folder = folder_.path(),
                                  .output = folder_.File("output"),
                                  .detached = false});
    EXPECT_OK(status);
    return status.value_or(-1);
  }
  std::string Output() const { return Contents(folder_.File("output")); }

  const TemporaryFolder folder_;
};

TEST_F(ChildProcessTest, ReturnsTheExitStatus) {
  EXPECT_EQ(RunShell("exit 0"), 0);
  EXPECT_EQ(RunShell("exit 7"), 7);
  EXPECT_EQ(RunShell("kill -9 $$"), 128 + 9);
}

TEST_F(ChildProcessTest, RunsInItsFolderAndAppendsItsOutputToAPrivateFile) {
  RunShell("pwd; echo error >&2");
  RunShell("echo again");
  EXPECT_EQ(Output(), std::filesystem::canonical(folder_.path()).string() + "\nerror\nagain\n");
  EXPECT_EQ(ModeOf(folder_.File("output")), 0600u);
}

TEST_F(ChildProcessTest, StartsWithNoSignalBlocked) {
  sigset_t sigint, old;
  sigemptyset(&sigint);
  sigaddset(&sigint, SIGINT);
  pthread_sigmask(SIG_BLOCK, &sigint, &old);
  EXPECT_EQ(RunShell("kill -INT $$; echo survived"), 128 + SIGINT);
  pthread_sigmask(SIG_SETMASK, &old, nullptr);
}

TEST_F(ChildProcessTest, AMissingProgramIsNotFound) {
  EXPECT_THAT(
      RunChild({.command = {"no-such-program"}, .folder = "", .output = "", .detached = false}),
      StatusIs(absl::StatusCode::kNotFound));
}

}  // namespace
}  // namespace ballpiston::client
