#include "client/library/child_process.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

std::string Contents(const fs::path& path) {
  std::ifstream in(path);
  return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

class ChildProcessTest : public ::testing::Test {
 protected:
  ChildProcessTest() {
    std::string pattern = (fs::temp_directory_path() / "child_test_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~ChildProcessTest() override { fs::remove_all(folder_); }

  int RunShell(const std::string& script) const {
    const auto status = RunChild({.command = {"sh", "-c", script},
                                  .folder = folder_.string(),
                                  .output = Output().string(),
                                  .detached = false});
    EXPECT_TRUE(status.ok()) << status.status();
    return status.value_or(-1);
  }
  fs::path Output() const { return folder_ / "output"; }

  fs::path folder_;
};

TEST_F(ChildProcessTest, ReturnsTheExitStatus) {
  EXPECT_EQ(RunShell("exit 0"), 0);
  EXPECT_EQ(RunShell("exit 7"), 7);
  EXPECT_EQ(RunShell("kill -9 $$"), 128 + 9);
}

TEST_F(ChildProcessTest, RunsInItsFolderAndAppendsItsOutput) {
  RunShell("pwd; echo error >&2");
  RunShell("echo again");
  EXPECT_EQ(Contents(Output()), fs::canonical(folder_).string() + "\nerror\nagain\n");
}

TEST_F(ChildProcessTest, StartsWithNoSignalBlocked) {
  sigset_t sigint, old;
  sigemptyset(&sigint);
  sigaddset(&sigint, SIGINT);
  pthread_sigmask(SIG_BLOCK, &sigint, &old);
  EXPECT_EQ(RunShell("kill -INT $$; echo survived"), 128 + SIGINT);
  pthread_sigmask(SIG_SETMASK, &old, nullptr);
}

TEST_F(ChildProcessTest, AProgramThatDoesNotExistIsNotFound) {
  const auto status =
      RunChild({.command = {"no-such-program"}, .folder = "", .output = "", .detached = false});
  EXPECT_EQ(status.status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace ballpiston::client
