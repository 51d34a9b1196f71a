// The tests run this program as a process of its own and let it hang.
#include "tests/support/time_limit.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

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

[[gnu::noinline]] void SleepAgainAndAgain() {
  while (true) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Disabled: run by TimeLimit.HangingTestPrintsItsNameAndTheStacksOfAllThreads only.
TEST(DISABLED_HangingTest, NeverEnds) {
  std::thread([] { SleepAgainAndAgain(); }).detach();
  WaitForAnAnswerThatNeverComes();
}

ProcessResult RunThisProgram(const std::string& test, const std::string& time_scale) {
  return RunProgram({.command = {BuildPath("bin/support_test"), "--gtest_also_run_disabled_tests",
                                 "--gtest_filter=" + test},
                     .environment = {{"BALLPISTON_TEST_TIME_SCALE", time_scale},
                                     {"GTEST_TOTAL_SHARDS", ""},
                                     {"GTEST_SHARD_INDEX", ""}}});
}

TEST(TimeLimit, HangingTestPrintsItsNameAndTheStacksOfAllThreads) {
  const ProcessResult result = RunThisProgram("DISABLED_HangingTest.NeverEnds", "0.01");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("DISABLED_HangingTest.NeverEnds has not ended after 0.6 s"),
                    HasSubstr("WaitForAnAnswerThatNeverComes"), HasSubstr("SleepAgainAndAgain")));
}

TEST(TimeLimit, TestThatEndsInTimePasses) {
  const ProcessResult result = RunThisProgram("TimeLimit.UsualLimitIsAMinute", "1");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(TimeLimit, UsualLimitIsAMinute) {
  EXPECT_EQ(TimeLimitOf("Suite.Name"), std::chrono::seconds(60));
  EXPECT_EQ(TimeLimitOf("KillsOfOthers.Name"), std::chrono::seconds(60));
}

TEST(TimeLimit, SuitesThatNeedLongerAreNamed) {
  EXPECT_EQ(TimeLimitOf("Kills.Name"), std::chrono::seconds(300));
}

}  // namespace
}  // namespace ballpiston
