// The program as a process: rare events decide which cells are empty.
#include "tests/core/preamble.h"
#include "tests/support/process.h"

namespace ballpiston::slow_pistons {
namespace {

// The rows that the program prints, as cells.
std::vector<std::vector<std::string>> Rows(std::vector<std::string> flags) {
  flags.insert(flags.begin(), BuildPath("bin/slow_pistons"));
  const ProcessResult result = RunProgram({.command = std::move(flags)});
  EXPECT_THAT(result, ExitsWith(0));
  std::vector<std::vector<std::string>> rows;
  for (const absl::string_view line : absl::StrSplit(result.out, '\n', absl::SkipEmpty())) {
    rows.push_back(absl::StrSplit(line, ','));
  }
  return rows;
}

TEST(Program, SharesWithoutLongIdleTimesAreEmpty) {
  const auto rows = Rows({"idle", "--block", "10", "--blocks", "10"});
  ASSERT_EQ(rows.size(), 19u);
  for (const size_t piston : {0, 1}) {
    const std::vector<std::string>& longest = rows[9 + 9 * piston];
    EXPECT_EQ(std::vector(longest.begin() + 1, longest.end()),
              (std::vector<std::string>{"1024", "", "", "", ""}));
  }
}

TEST(Program, FewSlowArrivalsGiveNoError) {
  const auto rows = Rows({"idle", "--block", "500", "--blocks", "8"});
  EXPECT_NE(rows[10][5], "");  // of the cold piston at s = 4
  const bool has_value_alone =
      std::ranges::any_of(rows, [](const auto& row) { return row[4] != "" && row[5] == ""; });
  EXPECT_TRUE(has_value_alone);
}

TEST(Program, GrowthWithoutLongIdleTimesHasNoError) {
  const auto rows = Rows({"windows", "--delta", "0.1", "--orbits", "256"});
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0][8], "later_idle_error");
  EXPECT_EQ(rows[1][8], "0");  // the first window
  EXPECT_NE(rows[5][4], "");   // idle_error
  EXPECT_EQ(rows[5][8], "");
}

TEST(Program, ANumberOutOfRangeExitsWithTwo) {
  for (const char* flag :
       {"--hot=nan", "--cold=1e300", "--block=nan", "--seed=-1", "--cells=01001"}) {
    const std::vector<std::string> command = {BuildPath("bin/slow_pistons"), "idle", flag};
    EXPECT_THAT(RunProgram({.command = command}), ExitsWith(2)) << flag;
  }
}

}  // namespace
}  // namespace ballpiston::slow_pistons
