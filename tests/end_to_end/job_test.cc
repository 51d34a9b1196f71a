// What users do with jobs: run, submit, watch, result, list, cancel, delete.

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

TEST(Run, PrintsATableWithExactValues) {
  const TestServer server;
  const ProcessResult result =
      server.Client(Split("run equilibrium --rho 0.529561127988977 --delta 0.2 --collisions 5000 "
                          "--verify"));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.out, StartsWith("equilibrium, model billiard, seed 0, "));
  EXPECT_THAT(result.out, HasSubstr("mean_free_time_ball_piston"));
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 6);
  EXPECT_EQ(result.err, "");  // not a terminal: no progress
}

TEST(Run, TakesASpecificationFromAFileOrStandardInput) {
  const TestServer server;
  const std::string spec = R"({"experiment": "EQUILIBRIUM", "grid": {"rho": [0.53],
                              "delta": [0.2]}, "target": {"collisions": 1000}, "seed": 5})";
  WriteFile(server.folder().File("spec.json"), spec);
  const ProcessResult file =
      server.Client({"run", "--spec", server.folder().File("spec.json"), "--format", "json"});
  const ProcessResult stdin_ = server.Client({"run", "--spec", "-", "--format", "json"}, spec);
  const ProcessResult flags =
      server.Client(Split("run equilibrium --rho 0.53 --delta 0.2 --collisions 1000 --seed 5 "
                          "--format json"));
  EXPECT_THAT(file, ExitsWith(0));
  EXPECT_EQ(PointsOf(file.out), PointsOf(stdin_.out));
  EXPECT_EQ(PointsOf(file.out), PointsOf(flags.out));
}

TEST(Run, ARepeatedQuestionIsAnsweredFromTheStoreUnlessItIsFresh) {
  const TestServer server;
  const auto run = [&](const Words& flags) {
    const ProcessResult result =
        server.Client(Joined({{"run", "--format", "json"}, kQuickQuestion, flags}));
    EXPECT_THAT(result, ExitsWith(0));
    return result;
  };
  const auto name = [](const ProcessResult& result) {
    return At(ParseJson(result.out), "job", "name").string_value();
  };
  const ProcessResult first = run({}), again = run({}), fresh = run({"--fresh"});
  EXPECT_THAT(again.err, StartsWith("answered from the store: " + name(first) + ", computed 2"));
  EXPECT_EQ(name(again), name(first));
  EXPECT_EQ(fresh.err, "");
  EXPECT_NE(name(fresh), name(first));
  for (const ProcessResult& later : {again, fresh}) {
    EXPECT_EQ(PointsOf(later.out), PointsOf(first.out));
  }
}

TEST(Submit, PrintsTheNameThatWatchAndResultTake) {
  const TestServer server;
  const ProcessResult submitted = server.Client(Joined({{"submit"}, kQuickQuestion}));
  ASSERT_THAT(submitted, ExitsWith(0));
  EXPECT_THAT(submitted.out, ::testing::MatchesRegex("ensembleJobs/[-_A-Za-z0-9]+\n"));
  EXPECT_EQ(submitted.err, "");
  const std::string name = submitted.out.substr(0, submitted.out.size() - 1);
  const std::string id = name.substr(name.find('/') + 1);
  EXPECT_THAT(server.Client({"watch", name}), ExitsWith(0));
  const ProcessResult by_name = server.Client({"result", name});
  EXPECT_THAT(by_name, ExitsWith(0));
  EXPECT_EQ(by_name.out, server.Client({"result", id}).out);
  const ProcessResult list = server.Client({"list", "--format", "csv"});
  EXPECT_THAT(list.out, HasSubstr(name + ",first-hit,succeeded,2,2,4000,"));
}

TEST(Cancel, StopsAJobOnce) {
  const TestServer server;
  const std::string job = server.Submit(kEndlessQuestion);
  EXPECT_THAT(server.Client({"delete", job}), ExitsWith(4));  // still active
  const ProcessResult cancelled = server.Client({"cancel", job});
  EXPECT_THAT(cancelled, ExitsWith(0));
  EXPECT_THAT(server.Client({"watch", job}), ExitsWith(4));
  const ProcessResult again = server.Client({"cancel", job});
  EXPECT_THAT(again, ExitsWith(4));
  EXPECT_THAT(again.err, HasSubstr("JOB_ALREADY_ENDED"));
  const ProcessResult result = server.Client({"result", job});
  EXPECT_THAT(result, ExitsWith(4));
  EXPECT_THAT(result.err, HasSubstr(job + " cancelled"));
}

// The reader takes one line and ends: `ballpiston result JOB | head -n 1`.
TEST(Result, ClosedPipeExitsWithZero) {
  const TestServer server;
  const std::string job =
      server.Submit(Split("equilibrium --rho 0.53 --delta 0.01:0.2:2000 --collisions 1"));
  ASSERT_THAT(server.Client({"watch", job}), ExitsWith(0));
  const std::string command = ClientProgram() + " result " + job + " --server " + server.address() +
                              " --format csv; echo \"exit $?\" >&2";
  const ProcessResult piped =
      RunProgram({.command = {"bash", "-c", "{ " + command + "; } | head -n 1"},
                  .environment = CleanEnvironment(server.folder())});
  EXPECT_EQ(piped.err, "exit 0\n");
  EXPECT_EQ(std::count(piped.out.begin(), piped.out.end(), '\n'), 1);
}

TEST(Result, AFullDiskIsAnError) {
  const TestServer server;
  const ProcessResult full = RunProgram(
      {.command = {"bash", "-c",
                   ClientProgram() + " list --server " + server.address() + " > /dev/full"},
       .environment = CleanEnvironment(server.folder())});
  EXPECT_THAT(full, ExitsWith(4));
  EXPECT_THAT(full.err, HasSubstr("cannot write standard output: No space left"));
}

}  // namespace
}  // namespace ballpiston
