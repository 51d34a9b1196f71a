// The program as a process, with the smallest budget.
#include "tests/core/preamble.h"
#include "tests/support/process.h"

namespace ballpiston::method_comparison {
namespace {

ProcessResult RunComparison(std::vector<std::string> flags) {
  flags.insert(flags.begin(), BuildPath("bin/method_comparison"));
  return RunProgram({.command = std::move(flags)});
}

TEST(Program, PrintsRowsAndClearsTheProgressLine) {
  const ProcessResult result = RunComparison(
      {"--seconds", "0.01", "--delta=0.2", "--relaxation-delta", "0.2,0.3", "--progress", "bar"});
  EXPECT_THAT(result, ExitsWith(0));
  std::istringstream lines(result.out);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line,
            "rho,delta,epsilon,method,time_step,quantity,samples,wall_hits,work_seconds,value,"
            "statistical_error,own_error,bias_resolved");
  while (std::getline(lines, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 12) << line;
  }
  const std::string rho = "\n0.529561127988977,";
  for (const char* curve :
       {"0.2,0.125,fixed-step,0.01,mean-free-time,16,", "0.2,0.125,closed-form,0,ingoing-law,0,",
        "0.2,0.125,billiard-reference-quadruple,0,trajectory,",
        "0.3,0.125,markov,0,relaxation-time,512,", "0.3,0.125,spectrum,0,relaxation-time,0,0,",
        "0.2,0.125,markov,0,heat-current,512,"}) {
    EXPECT_THAT(result.out, HasSubstr(rho + curve));
  }
  EXPECT_THAT(result.err, StartsWith("\r  1 measurements  mean-free-time, fixed-step 0.1: "));
  EXPECT_THAT(result.err, EndsWith("\r\x1b[K"));
  EXPECT_THAT(result.err, Not(HasSubstr("\n")));
}

// The heat current has its own default, which is permitted too.
TEST(Program, AnEmptyListOfRelaxationDeltasIsTheDefault) {
  const ProcessResult result =
      RunComparison({"--rho=0.65", "--delta=0.05", "--seconds=0.01", "--relaxation-delta="});
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.err, "");  // no progress: standard error is not a terminal
  for (const char* delta : {"0.05", "0.025"}) {
    EXPECT_THAT(result.out,
                HasSubstr(absl::StrCat("\n0.65,", delta, ",0.125,spectrum,0,relaxation-time,")));
  }
}

// All rows are still printed.
TEST(Program, APanelWithoutRunsExitsWithOneAndNamesTheFlags) {
  const ProcessResult result =
      RunComparison({"--seconds=0.01", "--delta=1e-9", "--relaxation-delta=1e-9"});
  EXPECT_THAT(result, ExitsWith(1));
  EXPECT_THAT(result.out, HasSubstr(",trajectory,"));
  EXPECT_THAT(result.err, HasSubstr("no method has 64 samples of mean-free-time in that time"));
  EXPECT_THAT(result.err, HasSubstr("--seconds or a larger --delta"));
}

// Each run has a second wrong value, so a value that is permitted by mistake starts no measurement.
TEST(Program, EveryValueThatIsNotPermittedIsNamedWithItsRange) {
  for (const auto& [flag, complaint] : std::vector<std::pair<std::string, std::string>>{
           {"--rho=0.3", "--rho: rho is 0.3;"},
           {"--delta=0", "--delta: delta is 0; permitted at rho"},
           {"--delta=0.4", "--delta: delta is 0.4; permitted at rho"},
           {"--delta=nan", "--delta: delta is nan; permitted at rho"},
           {"--epsilon=0", "--epsilon: 0 is not in (0, 1/2)"},
           {"--epsilon=0.5", "--epsilon: 0.5 is not in (0, 1/2)"},
           {"--epsilon=nan", "--epsilon: nan is not in (0, 1/2)"},
           {"--seconds=0.009", "--seconds: 0.009 is not in [0.01, 60]"},
           {"--seconds=61", "--seconds: 61 is not in [0.01, 60]"},
           {"--seconds=nan", "--seconds: nan is not in [0.01, 60]"},
           {"--relaxation-delta=0.1,0.5", "--relaxation-delta: delta is 0.5; permitted at rho"},
           {"--relaxation-delta=.1,.1,.1,.1,.1,.1,.1,.1",
            "--relaxation-delta: 9 values; permitted: at most 8"}}) {
    const ProcessResult result = RunComparison({"--relaxation-delta=-1", flag});
    EXPECT_THAT(result, ExitsWith(2));
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr("method_comparison: " + complaint));
    EXPECT_THAT(result.err,
                HasSubstr("method_comparison: --relaxation-delta: delta is -1; permitted"));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 2) << result.err;
  }
}

TEST(Program, AnUnknownFlagExitsWithTwoAndHelpWithZero) {
  EXPECT_THAT(RunComparison({"--sample=3"}), ExitsWith(2));
  EXPECT_THAT(RunComparison({"--seed=-1"}), ExitsWith(2));
  const ProcessResult help = RunComparison({"--help"});
  EXPECT_THAT(help, ExitsWith(0));
  EXPECT_THAT(help.out, HasSubstr("--relaxation-delta"));
  EXPECT_THAT(help.out, HasSubstr("It does not change"));
}

TEST(Program, OutputThatCannotBeWrittenExitsWithOne) {
  const std::string command = BuildPath("bin/method_comparison") +
                              " --seconds 0.01 --delta 1e-9 --relaxation-delta 0.2 >/dev/full";
  const ProcessResult result = RunProgram({.command = {"sh", "-c", command}});
  EXPECT_THAT(result, ExitsWith(1));
  EXPECT_THAT(result.err, HasSubstr("cannot write to standard output"));
}

}  // namespace
}  // namespace ballpiston::method_comparison
