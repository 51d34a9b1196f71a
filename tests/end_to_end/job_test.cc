// What users do with jobs: run, submit, watch, result, list, cancel, delete.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/end_to_end/programs.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

ProcessResult RunQuick(const TestServer& server, const std::string& flags) {
  return server.Client(Joined({{"run"}, kQuickQuestion, Split(flags)}));
}

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

TEST(Run, JsonHasTheContractsShape) {
  const TestServer server;
  const auto json = server.Json(Joined({{"run"}, kQuickQuestion}));
  EXPECT_THAT(At(json, "job", "name").string_value(), StartsWith("ensembleJobs/"));
  EXPECT_EQ(At(json, "job", "state").string_value(), "SUCCEEDED");
  EXPECT_EQ(At(json, "job", "spec", "seed").string_value(), "7");  // 64 bits: a string
  EXPECT_EQ(Length(At(json, "points")), 2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(At(json, "points", i, "index").number_value(), i);
    EXPECT_EQ(At(json, "points", i, "parameters", "rho").number_value(), 0.53);
    EXPECT_EQ(At(json, "points", i, "parameters", "delta").number_value(), i == 0 ? 0.2 : 0.1);
    EXPECT_EQ(At(json, "points", i, "parameters", "epsilon").number_value(), 0.1);
    EXPECT_EQ(At(json, "points", i, "parameters", "exponent").number_value(), 1);
    EXPECT_EQ(At(json, "points", i, "model").string_value(), "BILLIARD");
    EXPECT_EQ(At(json, "points", i, "samples").number_value(), 2000);
    EXPECT_EQ(At(json, "points", i, "estimates", 0, "name").string_value(), "mean_hit_time");
    EXPECT_GT(At(json, "points", i, "estimates", 0, "standard_error").number_value(), 0);
    EXPECT_LT(std::abs(At(json, "points", i, "estimates", 0, "z_score").number_value()), 5);
    EXPECT_EQ(At(json, "points", i, "kl_divergence", "cells").number_value(), 2000);
    EXPECT_EQ(Length(At(json, "points", i, "histograms")), 2);
    EXPECT_EQ(At(json, "points", i, "health", "escapes").number_value(), 0);
    EXPECT_TRUE(At(json, "points", i, "health", "escapes").has_number_value());
  }
}

TEST(Run, CsvAndJsonlHaveALineForEachEstimateOrPoint) {
  const TestServer server;
  const ProcessResult csv = RunQuick(server, "--format csv");
  EXPECT_THAT(
      csv.out,
      StartsWith("rho,delta,epsilon,exponent,model,samples,name,value,"
                 "standard_error,exact,z_score,model_error,noise_floor,limit\n0.53,0.2,0.1,1,"));
  const ProcessResult jsonl = RunQuick(server, "--format jsonl");
  EXPECT_EQ(std::count(jsonl.out.begin(), jsonl.out.end(), '\n'), 2);
  ParseJson(jsonl.out.substr(0, jsonl.out.find('\n')));
}

TEST(Run, ProgressGoesToStandardErrorOnly) {
  const TestServer server;
  const ProcessResult bar = RunQuick(server, "--progress bar");
  EXPECT_THAT(bar.err, HasSubstr("2/2 points"));
  EXPECT_EQ(bar.out.find('\r'), std::string::npos);
  const ProcessResult json = RunQuick(server, "--fresh --progress json");
  const auto first = ParseJson(json.err.substr(0, json.err.find('\n')));
  EXPECT_THAT(At(first, "job").string_value(), StartsWith("ensembleJobs/"));
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

TEST(List, ShowsTheNewestFirst) {
  const TestServer server;
  const std::string older = server.Submit(kQuickQuestion);
  const std::string newer = server.Submit(Joined({kQuickQuestion, {"--fresh"}}));
  const auto json = server.Json({"list"});
  EXPECT_EQ(At(json, "jobs", 0, "name").string_value(), newer);
  EXPECT_EQ(At(json, "jobs", 1, "name").string_value(), older);
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

TEST(Delete, RemovesAnEndedJob) {
  const TestServer server;
  const std::string job = server.Submit(kQuickQuestion);
  EXPECT_THAT(server.Client({"watch", job}), ExitsWith(0));
  EXPECT_THAT(server.Client({"delete", job}), ExitsWith(0));
  EXPECT_THAT(server.Client({"result", job}), ExitsWith(5));
  EXPECT_THAT(server.Client({"delete", job}), ExitsWith(5));
}

TEST(Result, OfAnActiveJobHoldsTheFinishedPoints) {
  const TestServer server;
  const std::string job = server.Submit(kEndlessQuestion);
  const ProcessResult result = server.Client({"result", job, "--format", "json"});
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.err, HasSubstr(job + " is still "));
  EXPECT_EQ(Length(At(ParseJson(result.out), "points")), 0);
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

TEST(Analytic, AnswersWithoutAJob) {
  const TestServer server;
  const auto json =
      server.Json(Split("analytic --rho 0.529561127988977 --delta 0.1,0.2 --epsilon 0.25,0.5"));
  EXPECT_EQ(Length(At(json, "points")), 2);
  EXPECT_DOUBLE_EQ(At(json, "points", 0, "lambda").number_value(), 0.3489125293076057);
  EXPECT_EQ(At(json, "points", 1, "energies", 0, "phi").number_value(), 1);  // 2 sqrt(1/4)
  EXPECT_EQ(Length(At(server.Json({"list"}), "jobs")), 0);
}

}  // namespace
}  // namespace ballpiston
