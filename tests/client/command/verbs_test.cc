// The verbs of the whole program without its main function: their output, notes and exit codes, and
// what they ask the server.
#include "client/command/verbs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "tests/client/program.h"
#include "tests/support/scoped_variable.h"

namespace ballpiston::client {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Words = std::vector<std::string>;

class VerbsTest : public ProgramTest {};

// ---- jobs ----

TEST_F(VerbsTest, SubmitPrintsTheNameAlone) {
  EXPECT_EQ(WithServer({"submit", "first-hit", "--rho", "0.53"}),
            (Outcome{0, "ensembleJobs/abc\n", ""}));
}

TEST_F(VerbsTest, RunPrintsTheResult) {
  const Outcome outcome = WithServer({"run", "first-hit", "--format", "csv"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("mean_hit_time,1.5,,,,,,\n"));
}

TEST_F(VerbsTest, TablesAreRequestedWithoutHistograms) {
  WithServer({"result", "abc"});
  WithServer({"result", "abc", "--format", "json"});
  ASSERT_EQ(server_.ensemble.Asked().results.size(), 2u);
  EXPECT_EQ(server_.ensemble.Asked().results[0].view(), v1::ListResultsRequest::BASIC);
  EXPECT_EQ(server_.ensemble.Asked().results[1].view(), v1::ListResultsRequest::FULL);
}

TEST_F(VerbsTest, ResultNotesThatAJobIsActive) {
  job().set_state(v1::EnsembleJob::RUNNING);
  job().mutable_progress()->set_points(9);
  const Outcome outcome = WithServer({"result", "ensembleJobs/abc"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("mean_hit_time"));
  EXPECT_EQ(outcome.err,
            "ballpiston: ensembleJobs/abc is still running: 1 of 9 points are finished\n");
}

TEST_F(VerbsTest, AFailedJobExitsWithFourAndPrintsItsReasonAndPoints) {
  job().set_state(v1::EnsembleJob::FAILED);
  job().mutable_error()->set_message("tolerance not reached within the budget: point 0");
  server_.ensemble.watches = {{{JobMessage(job(), "t")}, grpc::Status::OK}};
  for (const Words& words : {Words{"run", "first-hit"}, {"result", "abc"}, {"watch", "abc"}}) {
    const Outcome outcome = WithServer(words);
    EXPECT_EQ(outcome.code, 4);
    EXPECT_THAT(outcome.err, EndsWith("ensembleJobs/abc failed: tolerance not reached within the "
                                      "budget: point 0\n"));
    EXPECT_THAT(outcome.out, HasSubstr(words[0] == "watch" ? "" : "mean_hit_time"));
  }
}

TEST_F(VerbsTest, AnUnknownJobExitsWithFive) {
  server_.ensemble.watches = {{{}, JobNotFound("ensembleJobs/none")}};
  const Outcome unknown{5, "", "ballpiston: no such job: ensembleJobs/none (JOB_NOT_FOUND)\n"};
  for (const char* verb : {"watch", "result", "pin", "delete"}) {
    EXPECT_EQ(WithServer({verb, "none"}), unknown) << verb;
  }
}

TEST_F(VerbsTest, CancelPrintsTheStateOfEachJob) {
  EXPECT_EQ(WithServer({"cancel", "abc", "ensembleJobs/d"}),
            (Outcome{0, "ensembleJobs/abc cancelled\nensembleJobs/d cancelled\n",
                     "ensembleJobs/abc: 0 of 0 points are finished and stay\n"
                     "ensembleJobs/d: 0 of 0 points are finished and stay\n"}));
}

TEST_F(VerbsTest, CancelOfAnEndedJobExitsWithFourAfterAllJobs) {
  WithServer({"cancel", "b"});
  EXPECT_EQ(WithServer({"cancel", "-q", "a", "b", "c"}),
            (Outcome{4, "ensembleJobs/a cancelled\nensembleJobs/c cancelled\n",
                     "ballpiston: has ended already\n"}));
}

TEST_F(VerbsTest, PinPrintsEachJobOnceItIsPinned) {
  server_.ensemble.jobs.push_back(job());
  job().set_name("ensembleJobs/d");
  for (int i = 0; i < 2; ++i) {  // the second pin changes nothing
    EXPECT_EQ(WithServer({"pin", "abc", "none", "d"}),
              (Outcome{5, "ensembleJobs/abc pinned\nensembleJobs/d pinned\n",
                       "ballpiston: no such job: ensembleJobs/none (JOB_NOT_FOUND)\n"}));
  }
  const Outcome unpinned = WithServer({"pin", "--undo", "abc"});
  EXPECT_EQ(unpinned.code, 0) << unpinned.err;
  EXPECT_EQ(unpinned.out, "ensembleJobs/abc unpinned\n");
  EXPECT_FALSE(server_.ensemble.Asked().update.back().job().pinned());
}

TEST_F(VerbsTest, ExpiredResultsExitWithFourAndTheCommandThatComputesThemAgain) {
  job().set_results_expired(true);
  const std::string error =
      "ballpiston: ensembleJobs/abc: its results have expired (RESULTS_EXPIRED)\n"
      "To compute them again: ballpiston submit --again ensembleJobs/abc --server " +
      server_.Address() + "\n";
  for (const Words& words : {Words{"result", "abc"},
                             {"result", "abc", "--format", "json"},
                             {"result", "abc", "--point", "0"},
                             {"pin", "abc"}}) {
    EXPECT_EQ(WithServer(words), (Outcome{4, "", error}));
  }
}

TEST_F(VerbsTest, DeletePrintsEachDeletedJob) {
  server_.ensemble.jobs.push_back(job());
  job().set_name("ensembleJobs/d");
  const Outcome outcome = WithServer({"delete", "abc", "d", "none"});
  EXPECT_EQ(outcome.code, 5);
  EXPECT_EQ(outcome.out, "ensembleJobs/abc deleted\nensembleJobs/d deleted\n");
}

TEST_F(VerbsTest, LabelsSelectTheJobsOfTheServersList) {
  server_.ensemble.jobs.push_back(job());
  job().set_name("ensembleJobs/d");
  const Words words = {"delete", "--label", "run=7", "--yes"};
  EXPECT_EQ(WithServer(words),
            (Outcome{0, "ensembleJobs/d deleted\nensembleJobs/abc deleted\n", ""}));
  const v1::ListEnsembleJobsRequest list = server_.ensemble.Asked().list.at(0);
  EXPECT_EQ(list.labels().at("run"), "7");
  EXPECT_THAT(list.states(), ElementsAre(v1::EnsembleJob::SUCCEEDED, v1::EnsembleJob::FAILED,
                                         v1::EnsembleJob::CANCELLED));
  server_.ensemble.jobs.clear();
  EXPECT_EQ(WithServer(words).code, 5);
}

TEST_F(VerbsTest, ListRequestsGridsForJsonOnly) {
  WithServer({"list"});
  WithServer({"list", "--format", "csv"});
  WithServer({"list", "--format", "json"});
  const auto asked = server_.ensemble.Asked().list;
  ASSERT_EQ(asked.size(), 3u);
  EXPECT_EQ(asked[0].view(), v1::ListEnsembleJobsRequest::BASIC);
  EXPECT_EQ(asked[1].view(), v1::ListEnsembleJobsRequest::BASIC);
  EXPECT_EQ(asked[2].view(), v1::ListEnsembleJobsRequest::FULL);
}

TEST_F(VerbsTest, ListSaysWhenResultsExpire) {
  const absl::Time expiry = absl::Now() + absl::Hours(3 * 24 + 12);
  job().mutable_expire_time()->set_seconds(absl::ToUnixSeconds(expiry));
  EXPECT_THAT(WithServer({"list"}).out, EndsWith("  expires in 3 days\n"));
}

TEST_F(VerbsTest, ListSendsItsFilters) {
  const Outcome outcome =
      WithServer({"list", "--state", "running,queued", "--experiment", "first_hit,equilibrium",
                  "--since", "2026-01-31", "--limit", "10"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const auto asked = server_.ensemble.Asked().list;
  ASSERT_EQ(asked.size(), 1u);
  EXPECT_THAT(asked[0].states(), ElementsAre(v1::EnsembleJob::RUNNING, v1::EnsembleJob::QUEUED));
  EXPECT_THAT(asked[0].experiments(),
              ElementsAre(v1::EnsembleSpec::FIRST_HIT, v1::EnsembleSpec::EQUILIBRIUM));
  EXPECT_EQ(asked[0].since().seconds(), 1769817600);
  EXPECT_EQ(asked[0].page_size(), 10);
}

TEST_F(VerbsTest, EscapedOrbitsAreReported) {
  server_.ensemble.points[0].mutable_health()->set_escapes(3);
  EXPECT_THAT(WithServer({"result", "abc"}).err, HasSubstr("point 0: 3 orbits left the cell"));
}

TEST_F(VerbsTest, PlanPrintsTheLadderAndCreatesNoJob) {
  v1::PointPlan* point = server_.ensemble.plan.add_points();
  point->set_model(v1::EnsembleSpec::SPECTRUM);
  point->add_models()->set_model(v1::EnsembleSpec::SPECTRUM);
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

TEST_F(VerbsTest, AnInvalidSpecificationExitsWithTwoAndNamesTheFlagOrTheField) {
  const std::string file = home_.File("question.json");
  WriteFile(file, R"({"experiment": "EQUILIBRIUM"})");
  const struct {
    std::string field, description;
    Words words;
    std::string error;
  } cases[] = {
      {"spec.target.tolerance",
       "-1 is not in (0, 1)",
       {"equilibrium", "--tolerance", "-1"},
       "--tolerance: -1 is not in (0, 1)"},
      {"spec.target", "use target.collisions", {"equilibrium"}, "target: use --collisions"},
      {"spec.grid.rho[0]", "is 0.9", {"--spec", file}, "grid.rho[0]: is 0.9"}};
  for (const auto& [field, description, words, error] : cases) {
    server_.ensemble.plan_end = InvalidSpec(field, description);
    Words plan = words;
    plan.insert(plan.begin(), "plan");
    EXPECT_EQ(WithServer(plan), (Outcome{2, "", "ballpiston: " + error + " (INVALID_SPEC)\n"}));
  }
}

// ---- closed forms and the server ----

TEST_F(VerbsTest, AnalyticPrintsTheAnswer) {
  server_.analytic.response.add_points()->set_rho(0.53);
  const Outcome outcome =
      WithServer({"analytic", "--rho", "0.53", "--delta", "0.1", "--format", "jsonl"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, StartsWith("{\"rho\":0.53,"));
}

TEST_F(VerbsTest, AnalyticSendsEveryList) {
  WithServer({"analytic", "--rho", "0.53", "--delta", "0.1", "--epsilon", "0.2,0.3",
              "--outgoing-epsilon", "0.4", "--beta", "5", "--temperature", "6:8:3"});
  EXPECT_THAT(server_.analytic.asked.rho(), ElementsAre(0.53));
  EXPECT_THAT(server_.analytic.asked.delta(), ElementsAre(0.1));
  EXPECT_THAT(server_.analytic.asked.epsilon(), ElementsAre(0.2, 0.3));
  EXPECT_THAT(server_.analytic.asked.outgoing_epsilon(), ElementsAre(0.4));
  EXPECT_THAT(server_.analytic.asked.beta(), ElementsAre(5));
  EXPECT_THAT(server_.analytic.asked.temperature(), ElementsAre(6, 7, 8));
}

TEST_F(VerbsTest, StatusPrintsTheServersAnswer) {
  server_.server.status.set_version("1.2.3");
  server_.server.status.set_queued_jobs(17);
  const Outcome table = WithServer({"status"});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("server    1.2.3\n"));
  EXPECT_THAT(table.out, HasSubstr("17 queued"));
  EXPECT_EQ(table.err, "");
  EXPECT_THAT(WithServer({"server", "status", "--format", "json"}).out,
              HasSubstr("\"queued_jobs\":17,"));
}

// ---- figures ----

TEST_F(VerbsTest, HelpOfAGroupNamesItsVerbs) {
  const Outcome outcome = Ballpiston({"help", "server"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("  server start "), Not(HasSubstr("analytic"))));
  EXPECT_EQ(Ballpiston({"server", "--help"}).out, outcome.out);
}

TEST_F(VerbsTest, FigureListsItsNames) {
  EXPECT_THAT(Ballpiston({"figure", "--list"}).out, HasSubstr("mean-free-time: "));
}

// The package gets the flags as they were written, and the server in the environment.
TEST_F(VerbsTest, FigureStartsPythonAndReturnsItsExitCode) {
  const std::string python = home_.File("python");
  WriteFile(python,
            "#!/bin/sh\n[ \"$1\" = -c ] && exit 0  # the check of its modules\n"
            "echo \"$*\" $BALLPISTON_SERVER >" +
                home_.File("said") + "; exit 3\n");
  std::filesystem::permissions(python, std::filesystem::perms::owner_all);
  const ScopedVariable program("BALLPISTON_PYTHON", python);
  const ScopedVariable server("BALLPISTON_SERVER");  // the figure sets it
  const Outcome outcome =
      Ballpiston({"figure", "mean-free-time", "--out", "figures", "--quick", "--samples", "7",
                  "--relaxation-delta", "0.1,0.2", "--server", "h:1"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_EQ(Contents(home_.File("said")),
            "-m ballpiston.figures mean-free-time --out figures --quick --relaxation-delta 0.1,0.2 "
            "--samples 7 h:1\n");
}

}  // namespace
}  // namespace ballpiston::client
