// Figures, each from one command.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

bool HasGnuplot() {
  return RunProgram({.command = {"sh", "-c", "command -v gnuplot"}}).exit_code == 0;
}

Words MeanFreeTime(const std::string& folder) {
  return Split("figure mean-free-time --samples 200 --delta 0.2,0.1 --out " + folder);
}

int64_t RowsWithZScore(const std::string& csv) {
  constexpr size_t kZScore = 7;
  int64_t rows = 0;
  for (const absl::string_view line : absl::StrSplit(csv, '\n', absl::SkipEmpty())) {
    const std::vector<std::string> fields = absl::StrSplit(line, ',');
    rows += fields.size() > kZScore && !fields[kZScore].empty();
  }
  return rows - 1;  // the heading
}

TEST(Figure, LeavesDataScriptAndPicture) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const TestServer server;
  const std::string folder = server.folder().File("out/figure");  // created with its parents
  const ProcessResult result = server.Client(MeanFreeTime(folder));
  EXPECT_THAT(result, ExitsWith(0));
  const std::string csv = Contents(folder + "/mean-free-time.csv");
  // At each delta 59 energies and 3 mean free times; rare long returns leave some without an error.
  const auto compared = 2 * 3 + RowsWithZScore(csv);
  EXPECT_GT(compared, 100);
  EXPECT_THAT(result.err, HasSubstr(absl::StrCat("among ", compared, " estimates")));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 59);
  const std::string svg = Contents(folder + "/mean-free-time.svg");
  EXPECT_THAT(svg, HasSubstr("</svg>"));
  EXPECT_THAT(svg, HasSubstr("δ = 0.1"));
  EXPECT_THAT(result.out, HasSubstr(folder + "/mean-free-time.svg\n"));
}

TEST(Figure, WithoutGnuplotLeavesDataAndScript) {
  const TestServer server;
  const std::string folder = server.folder().File("figure");
  ProcessOptions options = server.Command(MeanFreeTime(folder));
  options.environment["PATH"] = "/nonexistent";
  const ProcessResult result = RunProgram(options);
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.err, HasSubstr("gnuplot is not installed"));
  EXPECT_TRUE(fs::exists(folder + "/mean-free-time.gnuplot"));
  EXPECT_FALSE(fs::exists(folder + "/mean-free-time.svg"));
}

}  // namespace
}  // namespace ballpiston
