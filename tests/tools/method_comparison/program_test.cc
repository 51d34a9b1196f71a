// The program as a process, with the smallest budget.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace ballpiston::method_comparison {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

ProcessResult RunComparison(std::vector<std::string> flags) {
  flags.insert(flags.begin(), BuildPath("bin/method_comparison"));
  return RunProgram({.command = std::move(flags)});
}

TEST(Program, PrintsAnObjectALineForEachMeasurement) {
  const ProcessResult result =
      RunComparison({"--seconds", "0.01", "--delta=0.2", "--relaxation-delta", "0.2,0.3"});
  EXPECT_THAT(result, ExitsWith(0));
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_THAT(line, StartsWith("{\"method\":\""));
    EXPECT_THAT(line, EndsWith("}"));
  }
  for (const char* curve :
       {R"("fixed-step","time_step":0.01,"quantity":"mean-free-time","delta":0.2,"samples":16,)",
        R"("closed-form","time_step":0,"quantity":"ingoing-law","delta":0.2,"samples":0,)",
        R"("billiard-reference-quadruple","time_step":0,"quantity":"trajectory")",
        R"("markov","time_step":0,"quantity":"relaxation-time","delta":0.3,"samples":64,)"}) {
    EXPECT_THAT(result.out, HasSubstr(curve));
  }
  EXPECT_EQ(result.err, "");
}

TEST(Program, EveryValueThatIsNotPermittedIsNamed) {
  const ProcessResult result = RunComparison({"--delta=0.4", "--epsilon=-1", "--seconds=0.001"});
  EXPECT_THAT(result, ExitsWith(2));
  EXPECT_EQ(result.out, "");
  for (const char* flag : {"--delta: ", "--epsilon: -1 is not in", "--seconds: 0.001 is not in"}) {
    EXPECT_THAT(result.err, HasSubstr(std::string("method_comparison: ") + flag));
  }
}

TEST(Program, AnUnknownFlagExitsWithTwoAndHelpWithZero) {
  EXPECT_THAT(RunComparison({"--sample=3"}), ExitsWith(2));
  const ProcessResult help = RunComparison({"--help"});
  EXPECT_THAT(help, ExitsWith(0));
  EXPECT_THAT(help.out, HasSubstr("--relaxation-delta"));
}

TEST(Program, OutputThatCannotBeWrittenExitsWithOne) {
  const std::string command = BuildPath("bin/method_comparison") +
                              " --seconds 0.01 --delta 0.2 --relaxation-delta 0.2 >/dev/full";
  const ProcessResult result = RunProgram({.command = {"sh", "-c", command}});
  EXPECT_THAT(result, ExitsWith(1));
  EXPECT_THAT(result.err, HasSubstr("cannot write to standard output"));
}

}  // namespace
}  // namespace ballpiston::method_comparison
