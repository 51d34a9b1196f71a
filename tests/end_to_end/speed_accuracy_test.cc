// The figure that the program `method_comparison` measures, without a server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/end_to_end/programs.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class SpeedAccuracy : public testing::Test {
 protected:
  ProcessOptions Command(const Words& flags) const {
    return ClientCommand(home_, Joined({{"figure", "speed-accuracy", "--out", figure_}, flags}));
  }

  // Runs a copy of the client, with the shell script as its `method_comparison`; empty: without
  // one.
  ProcessResult RunWithProgram(const std::string& script) const {
    const fs::path program = home_.File("bin/method_comparison");
    fs::create_directories(program.parent_path());
    fs::copy(ClientProgram(), program.parent_path(), fs::copy_options::skip_existing);
    if (!script.empty()) {
      WriteFile(program, "#!/bin/sh\n" + script + "\n");
      fs::permissions(program, fs::perms::owner_all);
    }
    ProcessOptions options = Command({});
    options.command[0] = home_.File("bin/ballpiston");
    return RunProgram(options);
  }

  const TemporaryFolder home_;
  const std::string figure_ = home_.File("figure");
};

// The measured times are too short for meaningful numbers. The test checks that there are numbers.
TEST_F(SpeedAccuracy, LeavesDataScriptAndPicture) {
  const ProcessResult result = RunProgram(Command({"--seconds", "0.02", "--progress", "json"}));
  EXPECT_THAT(result, ExitsWith(0));
  const std::string csv = Contents(figure_ + "/speed-accuracy.csv");
  const auto rows = std::count(csv.begin(), csv.end(), '\n') - 1;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), rows);
  for (const char* curve : {"fixed-step,0.01,mean-free-time", "billiard-reference,0,ingoing-law",
                            "billiard-single,0,trajectory", "closed-form,0,mean-free-time"}) {
    EXPECT_THAT(csv, HasSubstr(curve));
  }
  EXPECT_TRUE(fs::exists(figure_ + "/speed-accuracy.gnuplot"));
  if (result.err.find("gnuplot is not installed") != std::string::npos) GTEST_SKIP();
  EXPECT_THAT(Contents(figure_ + "/speed-accuracy.svg"), HasSubstr("vector lanes, double"));
  EXPECT_THAT(result.out, HasSubstr(figure_ + "/speed-accuracy.svg\n"));
}

// The client's standard error is also the program's: Wait returns when both have ended.
TEST_F(SpeedAccuracy, CtrlCEndsTheProgramToo) {
  Process client(Command({"--seconds", "60", "--progress", "json"}));
  ASSERT_TRUE(client.WaitForErr("mean-free-time"));
  client.Signal(SIGINT);
  EXPECT_THAT(client.Wait(), ExitsWith(130));
}

TEST_F(SpeedAccuracy, WrongValuesAreNamedAndTheServerIsNotUsed) {
  const ProcessResult result = RunProgram(
      Command(Split("--delta 0.4 --epsilon 0.6 --seconds 0.001 --server unix:/nonexistent")));
  EXPECT_THAT(result, ExitsWith(2));
  for (const char* text : {"--delta: ", "--epsilon: ", "--seconds: ", "not on a server"}) {
    EXPECT_THAT(result.err, HasSubstr(text));
  }
}

TEST_F(SpeedAccuracy, AMissingProgramIsNamedWithItsPath) {
  const ProcessResult result = RunWithProgram("");
  EXPECT_THAT(result, ExitsWith(4));
  EXPECT_THAT(result.err, HasSubstr("is missing: " + home_.File("bin/method_comparison")));
}

TEST_F(SpeedAccuracy, AProgramThatFailsIsAnError) {
  const ProcessResult failed = RunWithProgram("exit 1");
  EXPECT_THAT(failed, ExitsWith(4));
  EXPECT_THAT(failed.err, HasSubstr("method_comparison ended with exit status 1"));
  const ProcessResult strange = RunWithProgram("echo hello");
  EXPECT_THAT(strange, ExitsWith(4));
  EXPECT_THAT(strange.err, HasSubstr("printed no measurement: hello"));
}

}  // namespace
}  // namespace ballpiston
