// The tests run this program as a process of its own and let it hang for a while.
#include "tests/support/watchdog.h"

#include <sys/resource.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston {

// In a namespace with a name, and not inlined, so that the stacks can show them. It waits in a
// system function that the thread sanitizer knows, because the sanitizer delivers a signal only
// there.
[[gnu::noinline]] void WaitForAnAnswerThatNeverComes() {
  std::mutex mutex;
  std::condition_variable answer;
  std::unique_lock lock(mutex);
  answer.wait(lock, [] { return false; });
}

[[gnu::noinline]] void SleepUntilFileExists(const char* path) {
  while (!std::filesystem::exists(path)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

namespace {

// Disabled: run by the tests below only.
TEST(DISABLED_HangingTest, EndsWhenToldTo) {
  std::thread([] { WaitForAnAnswerThatNeverComes(); }).detach();
  std::thread sleeper([] { SleepUntilFileExists(std::getenv("END_OF_TEST")); });
  sleeper.join();
}

TEST(DISABLED_HangingTest, OpensNoFiles) {
  rlimit usual;
  getrlimit(RLIMIT_NOFILE, &usual);
  const rlimit none = {.rlim_cur = 0, .rlim_max = usual.rlim_max};
  setrlimit(RLIMIT_NOFILE, &none);
  SleepUntilFileExists(std::getenv("END_OF_TEST"));
  setrlimit(RLIMIT_NOFILE, &usual);
}

ProcessOptions HangingTest(const std::string& name, const std::string& end_of_test) {
  return {.command = {BuildPath("bin/support_test"), "--gtest_also_run_disabled_tests",
                      "--gtest_filter=DISABLED_HangingTest." + name},
          .environment = {{"BALLPISTON_STACKS_AFTER", "0.1"},
                          {"END_OF_TEST", end_of_test},
                          {"GTEST_OUTPUT", ""},
                          {"GTEST_TOTAL_SHARDS", ""},
                          {"GTEST_SHARD_INDEX", ""}}};
}

TEST(Watchdog, PrintsTheStacksOfAllThreadsAndLetsTheTestGoOn) {
  const TemporaryFolder folder;
  const std::string end_of_test = folder.File("end");
  Process hanging(HangingTest("EndsWhenToldTo", end_of_test));
  EXPECT_TRUE(
      hanging.WaitForErr("DISABLED_HangingTest.EndsWhenToldTo has not ended after 0.1 s or more"));
  EXPECT_TRUE(hanging.WaitForErr("WaitForAnAnswerThatNeverComes"));
  EXPECT_TRUE(hanging.WaitForErr("SleepUntilFileExists"));
  std::ofstream{end_of_test};
  EXPECT_THAT(hanging.Wait(), ExitsWith(0));
}

TEST(Watchdog, LetsTheTestGoOnIfStacksCannotBeRead) {
  const TemporaryFolder folder;
  const std::string end_of_test = folder.File("end");
  Process hanging(HangingTest("OpensNoFiles", end_of_test));
  EXPECT_TRUE(hanging.WaitForErr("has not ended after 0.1 s or more"));
  EXPECT_TRUE(hanging.WaitForErr("  cannot be read\n"));
  std::ofstream{end_of_test};
  EXPECT_THAT(hanging.Wait(), ExitsWith(0));
}

}  // namespace
}  // namespace ballpiston
