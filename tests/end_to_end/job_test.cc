// Jobs by the command line: submit, watch, result, list, and files of questions and results. Two
// tests end the output early: the reader of a pipe leaves, and the disk is full.
#include <google/protobuf/util/json_util.h>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

class JobTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name) const { return server_.folder().File(name); }

  // The client as a command of bash, in which $client stands for `ballpiston` with the server.
  ProcessResult Bash(const std::string& command) const {
    ProcessOptions options = {.command = {"bash", "-c", command},
                              .environment = CleanEnvironment(server_.folder())};
    options.environment["BALLPISTON_SERVER"] = server_.address();
    options.environment["client"] = ClientProgram();
    return RunProgram(options);
  }
  double Streams() const { return At(server_.Json({"status"}), "streams").number_value(); }

  const TestServer server_;
};

TEST_F(JobTest, SubmitPrintsTheNameThatWatchAndResultTake) {
  const ProcessResult submitted = server_.Client(Joined({{"submit"}, kQuickQuestion}));
  ASSERT_THAT(submitted, ExitsWith(0));
  EXPECT_THAT(submitted.out, ::testing::MatchesRegex("ensembleJobs/[-_A-Za-z0-9]+\n"));
  EXPECT_EQ(submitted.err, "");
  const std::string name = submitted.out.substr(0, submitted.out.size() - 1);
  const std::string id = name.substr(name.find('/') + 1);
  EXPECT_THAT(server_.Client({"watch", name}), ExitsWith(0));
  const ProcessResult by_name = server_.Client({"result", name});
  EXPECT_THAT(by_name, ExitsWith(0));
  EXPECT_EQ(by_name.out, server_.Client({"result", id}).out);
  EXPECT_EQ(by_name.err, "");  // not a terminal: no progress
  const ProcessResult list = server_.Client({"list", "--format", "csv"});
  EXPECT_THAT(list.out, HasSubstr(name + ",first-hit,succeeded,2,2,4000,"));
}

TEST_F(JobTest, ASpecificationMayComeFromStandardInput) {
  const std::string spec = R"({"experiment": "EQUILIBRIUM", "grid": {"rho": [0.53],
                              "delta": [0.2]}, "target": {"collisions": 1000}, "seed": 5})";
  const ProcessResult input = server_.Client({"run", "--spec", "-", "--format", "json"}, spec);
  EXPECT_THAT(input, ExitsWith(0));
  const ProcessResult flags =
      server_.Client(Split("run equilibrium --rho 0.53 --delta 0.2 --collisions 1000 --seed 5 "
                           "--fresh --format json"));
  EXPECT_EQ(PointsOf(input.out), PointsOf(flags.out));
}

// The commands with which docs/answers.md verifies a file.
TEST_F(JobTest, TheQuestionOfASavedFileGivesTheSamePointsOnAnotherServer) {
  server_.Client(Joined({{"run"}, kQuickQuestion, {"--save", File("a.json")}}));
  std::string spec;
  google::protobuf::util::MessageToJsonString(
      At(ParseJson(Contents(File("a.json"))), "job", "spec"), &spec);
  WriteFile(File("spec.json"), spec);
  const TestServer other;
  ASSERT_THAT(
      other.Client({"run", "--fresh", "--spec", File("spec.json"), "--save", File("b.json")}),
      ExitsWith(0));
  EXPECT_EQ(PointsOf(Contents(File("b.json"))), PointsOf(Contents(File("a.json"))));
}

TEST_F(JobTest, ArraysNeedThePythonPackage) {
  ProcessOptions run =
      server_.Command(Joined({{"run"}, kQuickQuestion, {"--save", File("a.npz")}}));
  run.environment["BALLPISTON_PYTHON"] = "false";
  const ProcessResult refused = RunProgram(run);
  EXPECT_THAT(refused, ExitsWith(4));
  EXPECT_THAT(refused.err, HasSubstr("install python3-ballpiston and python3-numpy"));
  EXPECT_EQ(Length(At(server_.Json({"list"}), "jobs")), 0);
  EXPECT_FALSE(fs::exists(File("a.npz")));
}

// The reader takes one line and ends.
TEST_F(JobTest, AClosedPipeExitsWithZero) {
  const std::string job =
      server_.Submit(Split("equilibrium --rho 0.53 --delta 0.01:0.2:2000 --collisions 1"));
  ASSERT_THAT(server_.Client({"watch", job}), ExitsWith(0));
  for (const std::string& words : {"result " + job + " --format csv",
                                   std::string("trace --rho 0.53 --delta 0.2 --events 1e6")}) {
    const ProcessResult piped = Bash("{ $client " + words + "; echo exit $? >&2; } | head -n 1");
    EXPECT_EQ(piped.err, "exit 0\n");
    EXPECT_EQ(std::count(piped.out.begin(), piped.out.end(), '\n'), 1);
  }
  AwaitThat([this] { return Streams() == 0; });
}

TEST_F(JobTest, AFullDiskIsAnError) {
  const ProcessResult full = Bash("$client list >/dev/full");
  EXPECT_THAT(full, ExitsWith(4));
  EXPECT_THAT(full.err, HasSubstr("cannot write standard output: No space left"));
}

TEST_F(JobTest, AnInterruptionEndsATraceInTheServerToo) {
  for (const int signal : {SIGINT, SIGTERM}) {
    ProcessOptions options = server_.Command(Split("trace --rho 0.53 --delta 0.2 --events 1e6"));
    options.command.insert(options.command.begin(), {"sh", "-c", "exec \"$@\" >/dev/null", "sh"});
    Process trace(options);
    AwaitThat([this] { return Streams() == 1; });
    trace.Signal(signal);
    EXPECT_THAT(trace.Wait(), ExitsWith(130));
    AwaitThat([this] { return Streams() == 0; });
  }
}

}  // namespace
}  // namespace ballpiston
