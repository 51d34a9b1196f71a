// The test runs this program as a process of its own and lets it hang for a while.
#include "tests/support/watchdog.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "gtest/gtest.h"
#include "tests/support/await.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston {
namespace {

// Disabled: run by the test below only.
TEST(DISABLED_HangingTest, EndsWhenToldTo) {
  AwaitThat([] { return std::filesystem::exists(std::getenv("END_OF_TEST")); });
}

TEST(Watchdog, NamesTheTestThatHangsAndLetsItGoOn) {
  const TemporaryFolder folder;
  Process hanging({.command = {BuildPath("bin/support_test"), "--gtest_also_run_disabled_tests",
                               "--gtest_filter=DISABLED_HangingTest.EndsWhenToldTo"},
                   .environment = {{"BALLPISTON_HANGS_AFTER", "0.1"},
                                   {"END_OF_TEST", folder.File("end")},
                                   {"GTEST_OUTPUT", ""},
                                   {"GTEST_TOTAL_SHARDS", ""},
                                   {"GTEST_SHARD_INDEX", ""}}});
  EXPECT_TRUE(
      hanging.WaitForErr("DISABLED_HangingTest.EndsWhenToldTo has not ended after 0.1 s or more"));
  std::ofstream{folder.File("end")};
  EXPECT_THAT(hanging.Wait(), ExitsWith(0));
}

}  // namespace
}  // namespace ballpiston
