// The whole program but its main function, against a fake server.
#include "client/command/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "tests/client/fake_server.h"
#include "tests/support/scoped_variable.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::client {
namespace {

using ::testing::ElementsAre;
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

// A home whose private server is the one at `address`; no other can be started.
class PrivateHome {
 public:
  explicit PrivateHome(const std::string& address) {
    std::filesystem::create_directory(folder_.File("ballpiston"));
    std::filesystem::create_symlink(address.substr(std::string("unix:").size()),
                                    folder_.File("ballpiston/server.socket"));
  }

 private:
  const TemporaryFolder folder_;
  const ScopedVariable state_home_{"XDG_STATE_HOME", folder_.path()};
  const ScopedVariable server_program_{"BALLPISTON_SERVER_PROGRAM", "/bin/false"};
};

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
                                               {"run", "first-hit", "--priority", "high"},
                                               {"run", "first-hit", "--priority", "1e10"},
                                               {"submit", "first-hit", "--priority", "0.5"},
                                               {"submit", "brownian"},
                                               {"submit", "first-hit", "--request-id", "42"},
                                               {"run", "first-hit", "--request-id", ""},
                                               {"watch"},
                                               {"watch", "a", "b"},
                                               {"result", ""},
                                               {"result", "ensembleJobs/"},
                                               {"result", "a/b"},
                                               {"result", "ensembleJobs/\xff"},
                                               {"watch", "\xc3\xa9"},
                                               {"cancel", "ABC"},
                                               {"delete", std::string(64, 'a')},
                                               {"plan"},
                                               {"plan", "brownian"},
                                               {"plan", "equilibrium", "--progress", "bar"},
                                               {"plan", "equilibrium", "--format", "xml"},
                                               {"trace", "--events", "5"},
                                               {"list", "--server", "nowhere"},
                                               {"status", "--format", "csv"},
                                               {"status", "now"},
                                               {"analytic", "--rho", "0.53"},
                                               {"figure", "portrait", "--out", "x"},
                                               {"figure", "mean-free-time"},
                                               {"figure", "speed-accuracy"}};
  for (const auto& words : mistakes) {
    const Outcome outcome = Ballpiston(words);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.rfind("ballpiston: ", 0), 0u) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

TEST_F(CommandLineTest, AFigureRefusesTheFlagsOfAnother) {
  const Outcome chart = Ballpiston({"figure", "speed-accuracy", "--out", "x", "--samples", "9",
                                    "--delta", "0.1,0.2", "--progress", "loud"});
  EXPECT_EQ(chart.code, 2);
  EXPECT_THAT(chart.err, HasSubstr("not valid, 3 violations"));
  EXPECT_THAT(chart.err, HasSubstr("--samples: '9', but the figure speed-accuracy has no such"));
  EXPECT_THAT(chart.err, HasSubstr("--delta: '0.1,0.2'"));
  const Outcome times = Ballpiston({"figure", "mean-free-time", "--out", "x", "--seconds", "9",
                                    "--epsilon", "0.1", "--relaxation-delta", "0.2"});
  EXPECT_THAT(times.err, HasSubstr("--seconds: '9', but the figure mean-free-time has no such"));
  EXPECT_THAT(times.err, HasSubstr("--epsilon: '0.1', but"));
  EXPECT_THAT(times.err, HasSubstr("--relaxation-delta: '0.2', but"));
}

TEST_F(CommandLineTest, DeltasOfRelaxationAreAList) {
  const Outcome chart =
      Ballpiston({"figure", "speed-accuracy", "--out", "x", "--relaxation-delta", "0.1,x,0.2,"});
  EXPECT_EQ(chart.code, 2);
  EXPECT_THAT(chart.err, HasSubstr("--relaxation-delta: 'x'"));
}

TEST_F(CommandLineTest, MistakesOfAllFlagsAreShownAtOnce) {
  const Outcome run = Ballpiston({"run", "first-hit", "--exponent", "x", "--samples", "y",
                                  "--format", "xml", "--progress", "loud", "--server", "z"});
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.err,
            "ballpiston: not valid, 5 violations:\n"
            "  --exponent: 'x' is not a decimal number such as 0.1 or 1e-3\n"
            "  --samples: 'y' is not a whole number such as 10000 or 1e6\n"
            "  --format: 'xml' is not one of table, json, jsonl, csv\n"
            "  --progress: 'loud' is not one of auto, bar, json, none\n"
            "  --server: 'z' is not a server's address: the port is missing (write host:port or "
            "unix:PATH)\n");
  const Outcome analytic =
      Ballpiston({"analytic", "--rho", "nan", "--delta", "inf", "--epsilon", "nan"});
  EXPECT_EQ(analytic.code, 2);
  EXPECT_EQ(analytic.err,
            "ballpiston: not valid, 3 violations:\n"
            "  --rho: 'nan' is not a decimal number such as 0.1 or 1e-3\n"
            "  --delta: 'inf' is not a decimal number such as 0.1 or 1e-3\n"
            "  --epsilon: 'nan' is not a decimal number such as 0.1 or 1e-3\n");
}

TEST_F(CommandLineTest, WhatIsNotAJobsNameIsShownEscaped) {
  const Outcome outcome = Ballpiston({"result", "ensembleJobs/\xff\x1b"});
  EXPECT_THAT(outcome.err, HasSubstr("'ensembleJobs/\\xff\\x1b' is not a job's name"));
}

TEST_F(CommandLineTest, VerbsOfLaterVersionsAreKnownAsSuch) {
  for (const auto& words : {std::vector<std::string>{"trace", "--rho", "0.53", "--events", "9"},
                            {"trace", "--help"},
                            {"trace", "run", "list"}}) {
    const Outcome outcome = Ballpiston(words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err,
              "ballpiston: trace is not offered by this version; it offers analytic, plan, run, "
              "submit, watch, result, list, cancel, delete, status, figure\n");
  }
}

// A server that answers with bytes that are no text; Protocol Buffers would log it.
TEST_F(CommandLineTest, NoLibraryLogsToStandardError) {
  job().set_name("ensembleJobs/\xff");
  server_.Start();
  testing::internal::CaptureStderr();
  EXPECT_NE(WithServer({"submit", "first-hit"}).code, 0);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// The channel tries four times; then the server has left.
constexpr int kAttempts = 4;

TEST_F(CommandLineTest, APrivateServerThatIsJustLeavingIsAskedAgainWithTheSameId) {
  const PrivateHome home(server_.Address());
  server_.ensemble.unavailable_attempts = kAttempts;
  server_.Start();
  const Outcome outcome = Ballpiston({"submit", "first-hit", "--rho", "0.53"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "ensembleJobs/abc\n");
  const auto asked = server_.ensemble.Asked().create;
  ASSERT_EQ(std::ssize(asked), kAttempts + 1);
  EXPECT_EQ(asked.front().request_id(), asked.back().request_id());
}

// Another id would be that of a second cancel, of a job that has ended by then.
TEST_F(CommandLineTest, ACancelIsAskedAgainWithTheSameId) {
  const PrivateHome home(server_.Address());
  server_.ensemble.unavailable_attempts = kAttempts;
  server_.Start();
  const Outcome outcome = Ballpiston({"cancel", "abc"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(std::ssize(server_.ensemble.Asked().cancel), kAttempts + 1);
}

TEST_F(CommandLineTest, APrivateServerIsAskedAgainOnce) {
  const PrivateHome home(server_.Address());
  server_.ensemble.unavailable_attempts = 100;
  server_.Start();
  EXPECT_EQ(Ballpiston({"submit", "first-hit"}).code, 3);
  EXPECT_EQ(std::ssize(server_.ensemble.Asked().create), 2 * kAttempts);
}

TEST_F(CommandLineTest, ANamedServerIsNotAskedAgain) {
  server_.ensemble.unavailable_attempts = kAttempts;
  server_.Start();
  EXPECT_EQ(WithServer({"submit", "first-hit"}).code, 3);
  EXPECT_EQ(std::ssize(server_.ensemble.Asked().create), kAttempts);
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
  const ScopedVariable address("BALLPISTON_SERVER", server_.Address());
  EXPECT_EQ(Ballpiston({"list"}).code, 0);
}

TEST_F(CommandLineTest, RunPrintsTheResult) {
  server_.Start();
  const Outcome outcome = WithServer({"run", "first-hit", "--format", "csv"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("mean_hit_time,1.5,,,,,,\n"));
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
  job().mutable_error()->set_message("tolerance not reached within the budget: point 0");
  server_.ensemble.watches = {{{JobMessage(job(), "t")}, grpc::Status::OK}};
  server_.Start();
  for (const auto& words :
       {std::vector<std::string>{"run", "first-hit"}, {"watch", "abc"}, {"result", "abc"}}) {
    const Outcome outcome = WithServer(words);
    EXPECT_EQ(outcome.code, 4);
    EXPECT_THAT(outcome.err, HasSubstr("ensembleJobs/abc failed: tolerance not reached within the "
                                       "budget: point 0\n"));
  }
}

TEST_F(CommandLineTest, WhatAFailedJobFinishedIsPrinted) {
  job().set_state(v1::EnsembleJob::FAILED);
  server_.ensemble.watches = {{{JobMessage(job(), "t")}, grpc::Status::OK}};
  server_.Start();
  for (const auto& words : {std::vector<std::string>{"run", "first-hit"}, {"result", "abc"}}) {
    const Outcome outcome = WithServer(words);
    EXPECT_EQ(outcome.code, 4);
    EXPECT_THAT(outcome.out, HasSubstr("mean_hit_time"));
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

TEST_F(CommandLineTest, ARequestIdOfOnesOwnIsPassedOn) {
  const std::string id = "123e4567-e89b-12d3-a456-426614174000";
  server_.Start();
  for (const char* verb : {"submit", "run"}) {
    const Outcome outcome = WithServer({verb, "first-hit", "--request-id", id});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(server_.ensemble.Asked().create.back().request_id(), id);
  }
  const Outcome wrong = WithServer({"submit", "first-hit", "--request-id", "42"});
  EXPECT_EQ(wrong.err.rfind("ballpiston: --request-id: '42' is not a UUID like 1", 0), 0u)
      << wrong.err;
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

TEST_F(CommandLineTest, PlanPrintsTheLadderAndMakesNoJob) {
  v1::PointPlan* point = server_.ensemble.plan.add_points();
  point->set_model(v1::EnsembleSpec::SPECTRUM);
  point->add_models()->set_model(v1::EnsembleSpec::SPECTRUM);
  server_.Start();
  const Outcome outcome = WithServer({"plan", "energy-relaxation", "--rho", "0.53", "--tolerance",
                                      "1e-3", "--budget", "10", "--verify", "--format", "csv"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\n0,0,,,spectrum,true,false,,,,,\n"));
  EXPECT_EQ(outcome.err, "");
  const auto asked = server_.ensemble.Asked();
  EXPECT_TRUE(asked.create.empty());
  ASSERT_EQ(asked.plan.size(), 1u);
  const v1::EnsembleSpec& spec = asked.plan[0].spec();
  EXPECT_EQ(spec.experiment(), v1::EnsembleSpec::ENERGY_RELAXATION);
  EXPECT_EQ(spec.target().tolerance(), 1e-3);
  EXPECT_EQ(spec.target().budget().seconds(), 10);
  EXPECT_TRUE(spec.verify());
}

TEST_F(CommandLineTest, APlanForWhatIsNotValidExitsWithTwo) {
  server_.ensemble.plan_end = InvalidSpec("spec.target.tolerance", "-1 is not in (0, 1)");
  server_.Start();
  const Outcome outcome = WithServer({"plan", "equilibrium", "--tolerance", "-1"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "ballpiston: spec.target.tolerance: -1 is not in (0, 1) (INVALID_SPEC)\n");
}

TEST_F(CommandLineTest, APlanWithoutAServerExitsWithThree) {
  EXPECT_EQ(WithServer({"plan", "equilibrium"}).code, 3);
}

// ---- how a job is asked for, and what becomes of it ----

TEST_F(CommandLineTest, FreshAndPriorityReachTheServer) {
  server_.Start();
  EXPECT_EQ(WithServer({"submit", "equilibrium"}).code, 0);
  EXPECT_EQ(WithServer({"submit", "equilibrium", "--fresh", "--priority", "-7"}).code, 0);
  EXPECT_EQ(WithServer({"run", "equilibrium", "--priority", "100", "--fresh"}).code, 0);
  const auto asked = server_.ensemble.Asked().create;
  ASSERT_EQ(asked.size(), 3u);
  EXPECT_FALSE(asked[0].fresh());
  EXPECT_EQ(asked[0].priority(), 0);
  EXPECT_TRUE(asked[1].fresh());
  EXPECT_EQ(asked[1].priority(), -7);
  EXPECT_TRUE(asked[2].fresh());
  EXPECT_EQ(asked[2].priority(), 100);
}

TEST_F(CommandLineTest, AnAnswerFromTheStoreIsTold) {
  job().mutable_end_time()->set_seconds(1700000000);
  server_.ensemble.answers_from_store = true;
  server_.Start();
  const std::string told = "answered from the store: " + job().name() +
                           ", computed 2023-11-14 22:13 UTC (--fresh computes anew)";
  const Outcome submitted = WithServer({"submit", "equilibrium"});
  EXPECT_EQ(submitted.out, job().name() + "\n");
  EXPECT_EQ(submitted.err, told + "\n");
  const Outcome table = WithServer({"run", "equilibrium"});
  EXPECT_EQ(table.err, told + "\n");
  EXPECT_EQ(table.out, WithServer({"result", job().name()}).out);
  EXPECT_THAT(WithServer({"run", "equilibrium", "--progress", "json"}).err,
              testing::StartsWith("{\"note\": \"" + told + "\"}\n{\"job\": "));
  const Outcome quiet =
      WithServer({"run", "equilibrium", "--progress", "none", "--format", "json"});
  EXPECT_EQ(quiet.err, "");
  EXPECT_THAT(quiet.out, HasSubstr("\"answered_from_store\":true"));
}

TEST_F(CommandLineTest, AnAnswerThatWasComputedIsNotSaidToBeFromTheStore) {
  server_.Start();
  EXPECT_EQ(WithServer({"submit", "equilibrium"}).err, "");
  const Outcome run = WithServer({"run", "equilibrium", "--format", "json"});
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("\"answered_from_store\":false"));
}

TEST_F(CommandLineTest, AFullQueueExitsWithThreeAndSaysWhatToDo) {
  server_.ensemble.create_end = LimitExceeded("QUEUE_FULL", "10 jobs are active already");
  server_.Start();
  for (const char* verb : {"run", "submit"}) {
    const Outcome outcome = WithServer({verb, "equilibrium"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err,
              "ballpiston: 10 jobs are active already (QUEUE_FULL)\n"
              "Try again when some of them have ended.\n");
  }
}

TEST_F(CommandLineTest, AJobThatIsTooLargeForTheServerExitsWithTwoAndSaysWhatToDo) {
  server_.ensemble.create_end = LimitExceeded("TOO_MANY_POINTS", "the grid has 9 points");
  server_.Start();
  const Outcome outcome = WithServer({"submit", "equilibrium"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "ballpiston: the grid has 9 points (TOO_MANY_POINTS)\n"
            "Split the grid between several jobs.\n");
}

TEST_F(CommandLineTest, AnalyticPrintsWhatTheServerEvaluates) {
  server_.analytic.response.add_points()->set_rho(0.53);
  server_.Start();
  const Outcome outcome =
      WithServer({"analytic", "--rho", "0.53", "--delta", "0.1", "--format", "jsonl"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out.rfind("{\"rho\":0.53,", 0), 0u);
}

TEST_F(CommandLineTest, AnalyticSendsEveryList) {
  server_.Start();
  WithServer({"analytic", "--rho", "0.53", "--delta", "0.1", "--epsilon", "0.2,0.3",
              "--outgoing-epsilon", "0.4", "--beta", "5", "--temperature", "6:8:3"});
  EXPECT_THAT(server_.analytic.asked.epsilon(), ElementsAre(0.2, 0.3));
  EXPECT_THAT(server_.analytic.asked.outgoing_epsilon(), ElementsAre(0.4));
  EXPECT_THAT(server_.analytic.asked.beta(), ElementsAre(5));
  EXPECT_THAT(server_.analytic.asked.temperature(), ElementsAre(6, 7, 8));
}

TEST_F(CommandLineTest, StatusPrintsWhatTheServerTells) {
  server_.server.status.set_version("1.2.3");
  server_.server.status.set_queued_jobs(17);
  server_.Start();
  const Outcome table = WithServer({"status"});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("server    1.2.3\n"));
  EXPECT_THAT(table.out, HasSubstr("17 queued"));
  EXPECT_EQ(table.err, "");
  EXPECT_THAT(WithServer({"status", "--format", "json"}).out, HasSubstr("\"queued_jobs\":17,"));
}

TEST_F(CommandLineTest, StatusOfAPrivateServerAsksTheOneThatRuns) {
  const PrivateHome home(server_.Address());
  server_.Start();
  EXPECT_EQ(Ballpiston({"status"}).code, 0);
}

// The one that could be started is /bin/false: its failure would be told.
TEST_F(CommandLineTest, StatusStartsNoServer) {
  const PrivateHome home(server_.Address());
  const Outcome outcome = Ballpiston({"status"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.rfind("ballpiston: no private server is running (", 0), 0u) << outcome.err;
}

TEST_F(CommandLineTest, StatusOfANamedServerThatIsNotThereNamesIt) {
  const Outcome outcome = WithServer({"status"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("no answer from the server at " + server_.Address()));
}

}  // namespace
}  // namespace ballpiston::client
