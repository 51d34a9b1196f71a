// The tests run this program as a process of its own and let it hang.
#include "tests/support/time_limit.h"

#include <future>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace ballpiston {

// These two functions are in a named namespace and not inlined, so that the stacks show them.
[[gnu::noinline]] void WaitForAnAnswerThatNeverComes() {
  std::promise<void> answer;
  answer.get_future().wait();
}

[[gnu::noinline]] void ComputeForEver() {
  while (true) std::this_thread::yield();
}

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Disabled: run by TimeLimit.HangingTestPrintsItsNameAndTheStacksOfAllThreads only.
TEST(DISABLED_HangingTest, NeverEnds) {
  std::thread([] { ComputeForEver(); }).detach();
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
                    HasSubstr("WaitForAnAnswerThatNeverComes"), HasSubstr("ComputeForEver")));
}

TEST(TimeLimit, TestThatEndsInTimePasses) {
  const ProcessResult result = RunThisProgram("TimeLimit.UsualLimitIsAMinute", "1");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(TimeLimit, UsualLimitIsAMinute) {
  EXPECT_EQ(TimeLimitOf("Suite.Name"), std::chrono::seconds(60));
}

TEST(TimeLimit, TestsThatNeedLongerAreNamed) {
  EXPECT_EQ(TimeLimitOf("Kills.LoseNothing"), std::chrono::seconds(300));
}

}  // namespace
}  // namespace ballpiston
