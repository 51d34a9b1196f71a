// Jobs by the command line: submit, watch, result, list, and files of questions and results. Two
// tests end the output early: the reader of a pipe leaves, and the disk is full. Below: jobs whose
// results expire, and jobs whose model the service chooses.
#include <google/protobuf/util/json_util.h>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

class JobTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name) const { return server_.folder().File(name); }

  // The client as a command of bash, in which $client stands for `ballpiston` with the server.
  ProcessResult Bash(const std::string& command) const {
    ProcessOptions options = ClientCommand(server_.folder(), {});
    options.command = {"bash", "-c", command};
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
  EXPECT_THAT(refused, ExitsWith(2));
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

TEST_F(JobTest, AFullDiskOrClosedOutputIsAnError) {
  for (const auto& [out, why] : {std::pair(">/dev/full", "No space"), {">&-", "Bad file"}}) {
    const ProcessResult full = Bash(absl::StrCat("$client list ", out));
    EXPECT_THAT(full, ExitsWith(2));
    EXPECT_THAT(full.err, HasSubstr(absl::StrCat("cannot write standard output: ", why)));
  }
}

TEST_F(JobTest, ThePythonPackageRunsWhereTheParentIgnoresItsChildren) {
  const std::string figure = " figure cell --out '" + File("figure") + "'";
  EXPECT_THAT(Bash("env --ignore-signal=CHLD $client" + figure), ExitsWith(0));
}

// No thread has room for such a stack.
TEST_F(JobTest, AClientThatCannotStartAThreadSaysSo) {
#if defined(__SANITIZE_ADDRESS__) || defined(_GLIBCXX_TSAN)
  GTEST_SKIP() << "a sanitizer needs a stack of another size";
#endif
  if (Bash("ulimit -Hs").out != "unlimited\n") GTEST_SKIP() << "the stack has a hard limit";
  const ProcessResult refused = Bash("ulimit -s 1000000000000; exec $client list");
  EXPECT_THAT(refused, ExitsWith(3));
  EXPECT_THAT(refused.err, HasSubstr("cannot start a thread: retry later"));
}

// gRPC refuses the request; the client recognises gRPC's words.
TEST_F(JobTest, AQuestionThatIsTooLargeToBeSentIsAnError) {
  std::string numbers = "0.53";
  for (int i = 1; i < 1'000'000; ++i) numbers += ",0.53";
  WriteFile(File("million.json"),
            R"({"experiment": "EQUILIBRIUM", "grid": {"delta": [0.1], "rho": [)" + numbers + "]}}");
  const ProcessResult refused = server_.Client({"run", "--spec", File("million.json")});
  EXPECT_THAT(refused, ExitsWith(2));
  EXPECT_EQ(refused.out, "");
  EXPECT_THAT(refused.err, HasSubstr("too large to be sent: 80000"));
  EXPECT_THAT(refused.err, HasSubstr("at most 4194304"));
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

// ---- a store that is bounded: the oldest results expire, and can be computed again ----
//
// tests/server/book/stored_limits_test.cc tests which results stay.

ProcessResult RunJson(const TestServer& server, const Words& question) {
  ProcessResult run = server.Client(Joined({{"run", "--format", "json"}, question}));
  EXPECT_THAT(run, ExitsWith(0));
  return run;
}

// 40 points whose results take 200 kB.
ProcessResult RunSweep(const TestServer& server, int seed) {
  const std::string sweep =
      "--resume first-hit --rho 0.53 --delta 0.1:0.2:40 --epsilon 0.1 --exponent 1 --samples 500";
  return RunJson(server, Split(absl::StrCat(sweep, " --seed ", seed)));
}

TEST(Expiry, OldResultsExpireAndCanBeComputedAgain) {
  const TestServer server({.flags = {"--max-store-bytes=1000000"}});
  const ProcessResult old = RunSweep(server, 0);
  const std::string name = At(ParseJson(old.out), "job", "name").string_value();
  int seed = 1;
  AwaitThat([&] {
    const ProcessResult result = server.Client({"result", name});
    const bool has_expired = result.err.find("expired") != std::string::npos;
    if (!has_expired) RunSweep(server, seed++);
    return has_expired || testing::Test::HasFailure();
  });
  // The same command computes expired results again, as does the question of the job.
  for (const ProcessResult& again : {RunJson(server, {"--again", name}), RunSweep(server, 0)}) {
    EXPECT_NE(At(ParseJson(again.out), "job", "name").string_value(), name);
    EXPECT_EQ(PointsOf(again.out), PointsOf(old.out));
  }
}

// ---- the choice of the model is left to the service ----
//
// tests/core/model_choice/ladder_test.cc tests the choice itself.

// A field of the first point that is a text.
std::string TextOf(const google::protobuf::Struct& document, const char* field) {
  return At(document, "points", 0, field).string_value();
}

double NumberOf(const google::protobuf::Struct& document, const char* estimate, const char* field) {
  for (const auto& each : At(document, "points", 0, "estimates").list_value().values()) {
    if (At(each, "name").string_value() == estimate) return At(each, field).number_value();
  }
  ADD_FAILURE() << "no estimate " << estimate;
  return NAN;
}

// The result holds the number of samples that the budget permitted. A job with this number of
// samples gives the same values.
TEST(Budget, ItsNumberOfSamplesGivesTheSameNumbersAgain) {
  const TestServer server;
  const std::string question =
      "run first-hit --rho 0.5296 --delta 0.2 --epsilon 0.1 --exponent 1 --seed 4";
  const auto answer = server.Json(Split(question + " --budget 0.05"));
  const double samples = At(answer, "points", 0, "samples").number_value();
  const auto again = server.Json(Split(absl::StrFormat("%s --samples %.0f", question, samples)));
  // The blocks differ, so the same samples are summed in another order.
  EXPECT_NEAR(NumberOf(answer, "mean_hit_time", "value"), NumberOf(again, "mean_hit_time", "value"),
              1e-12 * NumberOf(answer, "mean_hit_time", "value"));
}

TEST(Spectrum, AnswersWhereItsStatedErrorIsWithinTheTolerance) {
  const TestServer server;
  const std::string question =
      "energy-relaxation --rho 0.53 --delta 0.01 --tolerance 0.003 --format json";
  const std::string reason = "the limit's error, up to 0.00059, is within the tolerance";
  EXPECT_THAT(server.Client(Split("plan " + question)).out, HasSubstr(reason));
  const auto answer = ParseJson(server.Client(Split("run " + question)).out);
  EXPECT_EQ(TextOf(answer, "model"), "SPECTRUM");
  EXPECT_EQ(TextOf(answer, "reason"), reason);
  EXPECT_NEAR(NumberOf(answer, "relaxation_time", "model_error") /
                  NumberOf(answer, "relaxation_time", "value"),
              0.00059, 5e-6);
}

}  // namespace
}  // namespace ballpiston
