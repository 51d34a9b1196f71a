// Jobs by the command line: submit, watch, result, list, and files of questions and results. Two
// tests end the output early: the reader of a pipe leaves, and the disk is full. Below: jobs whose
// results expire, and jobs whose model the service chooses.
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

// The commands with which docs/answers.md verifies a file.
TEST_F(JobTest, TheQuestionOfASavedFileGivesTheSamePointsOnAnotherServer) {
  server_.Client(Joined({{"run"}, kQuickQuestion, {"--save", File("a.json")}}));
  std::string spec;
  google::protobuf::util::MessageToJsonString(
      FromJson<file::v1::SavedResult>(Contents(File("a.json"))).job().spec(), &spec);
  WriteFile(File("spec.json"), spec);
  const TestServer other;
  ASSERT_THAT(Bash(absl::StrCat("<", File("spec.json"), " BALLPISTON_SERVER=", other.address(),
                                " $client run --fresh --spec - --save ", File("b.json"))),
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
  EXPECT_EQ(server_.List().jobs_size(), 0);
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
  AwaitThat([this] { return server_.Status().streams() == 0; });
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
    AwaitThat([this] { return server_.Status().streams() == 1; });
    trace.Signal(signal);
    EXPECT_THAT(trace.Wait(), ExitsWith(130));
    AwaitThat([this] { return server_.Status().streams() == 0; });
  }
}

// ---- a store that is bounded: the oldest results expire, and can be computed again ----
//
// tests/server/book/stored_limits_test.cc tests which results stay.

TEST(Expiry, TheSameCommandComputesExpiredResultsAgain) {
  const TestServer server({.flags = {"--max-store-bytes=1000000"}});
  const auto run = [&](const std::string& question) {
    const ProcessResult result = server.Client(Split("run --format json " + question));
    EXPECT_THAT(result, ExitsWith(0));
    return result.out;
  };
  const auto sweep = [&](int seed) {  // 40 points whose results take 200 kB
    return run(absl::StrCat(
        "first-hit --rho 0.53 --delta 0.1:0.2:40 --epsilon 0.1 --exponent 1 --samples 500 "
        "--resume --seed ",
        seed));
  };
  const std::string old = sweep(0);
  const std::string name = FromJson<file::v1::SavedResult>(old).job().name();
  for (int seed = 1; seed < 100 && server.Client({"result", name}).exit_code == 0; ++seed) {
    sweep(seed);
  }
  EXPECT_THAT(server.Client({"result", name}).err, HasSubstr("expired"));
  for (const std::string& again : {run("--again " + name), sweep(0)}) {
    EXPECT_NE(FromJson<file::v1::SavedResult>(again).job().name(), name);
    EXPECT_EQ(PointsOf(again), PointsOf(old));
  }
}

// ---- the choice of the model is left to the service ----
//
// tests/core/model_choice/ladder_test.cc tests the choice itself.

// The first point of an answer.
v1::PointResult PointOf(const TestServer& server, const std::string& question) {
  return server.Json<file::v1::SavedResult>(Split("run " + question)).points().at(0);
}

// The first estimate, which has this name and a positive value.
v1::Estimate EstimateOf(const v1::PointResult& point, const std::string& name) {
  const v1::Estimate& estimate = point.estimates().at(0);
  EXPECT_EQ(estimate.name(), name);
  EXPECT_GT(estimate.value(), 0);
  return estimate;
}

// The result holds the number of samples that the budget permitted. A job with this number of
// samples gives the same values.
TEST(Budget, ItsNumberOfSamplesGivesTheSameNumbersAgain) {
  const TestServer server;
  const std::string question =
      "first-hit --rho 0.5296 --delta 0.2 --epsilon 0.1 --exponent 1 --seed 4";
  const v1::PointResult answer = PointOf(server, question + " --budget 0.05");
  const v1::PointResult again =
      PointOf(server, absl::StrFormat("%s --samples %.0f", question, answer.samples()));
  // The blocks differ, so the same samples are summed in another order.
  const double value = EstimateOf(answer, "mean_hit_time").value();
  EXPECT_NEAR(EstimateOf(again, "mean_hit_time").value(), value, 1e-12 * value);
}

TEST(Spectrum, AnswersWhereItsStatedErrorIsWithinTheTolerance) {
  const TestServer server;
  const std::string question = "energy-relaxation --rho 0.53 --delta 0.01 --tolerance 0.003";
  const std::string reason = "the limit's error, up to 0.00059, is within the tolerance";
  EXPECT_THAT(server.Client(Split("plan " + question)).out, HasSubstr(reason));
  const v1::PointResult answer = PointOf(server, question);
  EXPECT_EQ(answer.model(), v1::EnsembleSpec::SPECTRUM);
  EXPECT_EQ(answer.reason(), reason);
  const v1::Estimate time = EstimateOf(answer, "relaxation_time");
  EXPECT_NEAR(time.model_error() / time.value(), 0.00059, 5e-6);
}

}  // namespace
}  // namespace ballpiston
