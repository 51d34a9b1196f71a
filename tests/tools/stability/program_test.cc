// Arguments and exit status of the program.
#include "tests/support/paths.h"
#include "tests/support/preamble.h"
#include "tests/support/process.h"

namespace ballpiston::stability {
namespace {

ProcessResult RunStability(const std::string& arguments) {
  return RunProgram({.command = {"sh", "-c", BuildPath("bin/stability") + " " + arguments}});
}

TEST(Program, HelpExitsWithZeroAndAWrongArgumentWithTwo) {
  const ProcessResult help = RunStability("--help");
  EXPECT_THAT(help, ExitsWith(0));
  EXPECT_THAT(help.out, HasSubstr("--quick"));
  for (const char* argument : {"--fast", "stability.md", ""}) {
    const ProcessResult result = RunStability(absl::StrCat("--quick '", argument, "'"));
    EXPECT_THAT(result, ExitsWith(2));
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(absl::StrCat("'", argument, "'")));
  }
}

TEST(Program, OutputThatCannotBeWrittenExitsWithOne) {
  const ProcessResult result = RunStability("--help >/dev/full");
  EXPECT_THAT(result, ExitsWith(1));
  EXPECT_THAT(result.err, HasSubstr("cannot write to standard output"));
}

}  // namespace
}  // namespace ballpiston::stability
