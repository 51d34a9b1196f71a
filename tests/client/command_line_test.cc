// The whole program but its main function, against a fake server.
#include "client/command/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "tests/client/fake_server.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;

struct Outcome {
  int code;
  std::string out;
  std::string err;
};

Outcome Ballpiston(std::vector<std::string> words) {
  std::vector<const char*> argv = {"ballpiston"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  std::ostringstream out, err;
  Terminal terminal{out, err};
  const ExitCode code = RunCommandLine(static_cast<int>(argv.size()), argv.data(), terminal);
  return {static_cast<int>(code), out.str(), err.str()};
}

class CommandLineTest : public ::testing::Test {
 protected:
  CommandLineTest() {
    v1::EnsembleJob job = JobIn(v1::EnsembleJob::SUCCEEDED);
    job.mutable_progress()->set_points(1);
    job.mutable_progress()->set_points_done(1);
    server_.ensemble.jobs = {job};
    server_.ensemble.watches = {{{JobMessage(job, "t")}, grpc::Status::OK}};
    v1::PointResult point;
    v1::Estimate* estimate = point.add_estimates();
    estimate->set_name("mean_hit_time");
    estimate->set_value(1.5);
    server_.ensemble.points = {point};
  }

  Outcome WithServer(std::vector<std::string> words) {
    words.insert(words.end(), {"--server", server_.Address()});
    return Ballpiston(words);
  }
  v1::EnsembleJob& job() { return server_.ensemble.jobs[0]; }

  FakeServer server_;
};

TEST_F(CommandLineTest, HelpIsNoMistake) {
  const Outcome outcome = Ballpiston({"--help"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("Exit codes:"));
  EXPECT_EQ(Ballpiston({"run", "--help"}).code, 0);
}

TEST_F(CommandLineTest, MistakesExitWithTwoAndOneLine) {
  const std::vector<std::string> mistakes[] = {{},
                                               {"dance"},
                                               {"run"},
                                               {"run", "first-hit", "--speed", "3"},
                                               {"run", "first-hit", "--rho"},
                                               {"run", "first-hit", "--format", "xml"},
                                               {"run", "first-hit", "--progress", "loud"},
                                               {"run", "first-hit", "--rho", "1", "--rho", "2"},
                                               {"run", "first-hit", "second"},
                                               {"submit", "brownian"},
                                               {"watch"},
                                               {"watch", "a", "b"},
                                               {"result", ""},
                                               {"result", "ensembleJobs/"},
                                               {"result", "a/b"},
                                               {"list", "--server", "nowhere"},
                                               {"analytic", "--rho", "0.53"},
                                               {"figure", "portrait", "--out", "x"},
                                               {"figure", "mean-free-time"}};
  for (const auto& words : mistakes) {
    const Outcome outcome = Ballpiston(words);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.rfind("ballpiston: ", 0), 0u) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

TEST_F(CommandLineTest, WithoutAServerExitsWithThreeAndNamesIt) {
  const Outcome outcome = WithServer({"list"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("no answer from the server at " + server_.Address()));
}

TEST_F(CommandLineTest, SubmitPrintsTheNameAlone) {
  server_.Start();
  const Outcome outcome = WithServer({"submit", "first-hit", "--rho", "0.53"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out, "ensembleJobs/abc\n");
  EXPECT_EQ(outcome.err, "");
}

TEST_F(CommandLineTest, TheServerMayComeFromTheEnvironment) {
  server_.Start();
  setenv("BALLPISTON_SERVER", server_.Address().c_str(), 1);
  EXPECT_EQ(Ballpiston({"list"}).code, 0);
  unsetenv("BALLPISTON_SERVER");
}

TEST_F(CommandLineTest, RunPrintsTheResult) {
  server_.Start();
  const Outcome outcome = WithServer({"run", "first-hit", "--format", "csv"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("mean_hit_time,1.5,,,\n"));
}

TEST_F(CommandLineTest, TablesAreAskedForWithoutHistograms) {
  server_.Start();
  WithServer({"result", "abc"});
  WithServer({"result", "abc", "--format", "json"});
  ASSERT_EQ(server_.ensemble.Asked().results.size(), 2u);
  EXPECT_EQ(server_.ensemble.Asked().results[0].view(), v1::ListResultsRequest::BASIC);
  EXPECT_EQ(server_.ensemble.Asked().results[1].view(), v1::ListResultsRequest::FULL);
}

TEST_F(CommandLineTest, ResultOfAnActiveJobSaysSo) {
  job().set_state(v1::EnsembleJob::RUNNING);
  job().mutable_progress()->set_points(9);
  server_.Start();
  const Outcome outcome = WithServer({"result", "ensembleJobs/abc"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("mean_hit_time"));
  EXPECT_EQ(outcome.err,
            "ballpiston: ensembleJobs/abc is still running: 1 of 9 points are finished\n");
}

TEST_F(CommandLineTest, AFailedJobExitsWithFourAndItsReason) {
  job().set_state(v1::EnsembleJob::FAILED);
  job().mutable_error()->set_message("the disk is full");
  server_.ensemble.watches = {{{JobMessage(job(), "t")}, grpc::Status::OK}};
  server_.Start();
  for (const auto& words :
       {std::vector<std::string>{"run", "first-hit"}, {"watch", "abc"}, {"result", "abc"}}) {
    const Outcome outcome = WithServer(words);
    EXPECT_EQ(outcome.code, 4);
    EXPECT_THAT(outcome.err, HasSubstr("ensembleJobs/abc failed: the disk is full\n"));
  }
}

TEST_F(CommandLineTest, AnUnknownJobExitsWithFive) {
  server_.ensemble.watches = {{{}, JobNotFound("ensembleJobs/none")}};
  server_.Start();
  for (const char* verb : {"watch", "result", "delete"}) {
    const Outcome outcome = WithServer({verb, "none"});
    EXPECT_EQ(outcome.code, 5) << verb;
    EXPECT_EQ(outcome.err, "ballpiston: no such job: ensembleJobs/none (JOB_NOT_FOUND)\n");
  }
}

TEST_F(CommandLineTest, CancelPrintsTheStateAndRefusalExitsWithFour) {
  server_.Start();
  EXPECT_EQ(WithServer({"cancel", "abc"}).out, "ensembleJobs/abc cancelled\n");
  const Outcome again = WithServer({"cancel", "abc"});
  EXPECT_EQ(again.code, 4);
  EXPECT_EQ(again.err, "ballpiston: has ended already\n");
}

TEST_F(CommandLineTest, EscapedOrbitsAreNotPassedOverInSilence) {
  server_.ensemble.points[0].mutable_health()->set_escapes(3);
  server_.Start();
  EXPECT_THAT(WithServer({"result", "abc"}).err, HasSubstr("point 0: 3 orbits left the cell"));
}

TEST_F(CommandLineTest, AnalyticPrintsWhatTheServerEvaluates) {
  server_.analytic.response.add_points()->set_rho(0.53);
  server_.Start();
  const Outcome outcome =
      WithServer({"analytic", "--rho", "0.53", "--delta", "0.1", "--format", "jsonl"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out.rfind("{\"rho\":0.53,", 0), 0u);
}

}  // namespace
}  // namespace ballpiston::client
