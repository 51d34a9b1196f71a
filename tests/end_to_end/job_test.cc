// Jobs by the command line: files of questions and results, and errors of the system. Two
// tests end the output early: the reader of a pipe leaves, and the disk is full. Below: jobs whose
// results expire, and a job with a budget.
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

// The client finds the error before it submits a job.
TEST_F(JobTest, MissingProgramsAndPackagesOfPythonAreNamed) {
  const std::string modules = File("modules");
  const std::string arrays = File("a.npz");
  fs::create_directory(modules);
  WriteFile(modules + "/matplotlib.py", "raise ModuleNotFoundError(name='matplotlib')\n");
  const Words save = Joined({{"run"}, kQuickQuestion, {"--save", arrays}});
  const Words cell = {"figure", "cell", "--out", File("figure")};
  const struct {
    Words words;
    std::string variable, value, message;
  } cases[] = {
      {save, "BALLPISTON_PYTHON", "false", "install python3-ballpiston and python3-numpy"},
      {cell, "BALLPISTON_PYTHON", "/no/python3", "python3-ballpiston and python3-matplotlib"},
      {cell, "PYTHONPATH", modules, "cannot import matplotlib; install"}};
  for (const auto& [words, variable, value, message] : cases) {
    ProcessOptions options = server_.Command(words);
    options.environment[variable] = value;
    const ProcessResult refused = RunProgram(options);
    EXPECT_THAT(refused, ExitsWith(2));
    EXPECT_THAT(refused.err, HasSubstr(message));
  }
  EXPECT_EQ(server_.List().jobs_size(), 0);
  EXPECT_FALSE(fs::exists(arrays));
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

// The result holds the number of samples that the budget permitted. A job with this number of
// samples gives the same values.
TEST(Budget, ItsNumberOfSamplesGivesTheSameNumbersAgain) {
  const TestServer server;
  const std::string question =
      "first-hit --rho 0.5296 --delta 0.2 --epsilon 0.1 --exponent 1 --seed 4";
  const auto answer = [&](const std::string& target) {
    return server.Json<file::v1::SavedResult>(Split("run " + question + target)).points().at(0);
  };
  const v1::PointResult first = answer(" --budget 0.05");
  const v1::PointResult again = answer(absl::StrFormat(" --samples %.0f", first.samples()));
  EXPECT_EQ(first.estimates(0).name(), "mean_hit_time");
  // The blocks differ, so the same samples are summed in another order.
  const double value = first.estimates(0).value();
  EXPECT_GT(value, 0);
  EXPECT_NEAR(again.estimates(0).value(), value, 1e-12 * value);
}

}  // namespace
}  // namespace ballpiston
