// The whole program without its main function: how words are read, and the output of each verb.
#include "client/command/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_split.h"
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

class CommandLineTest : public ProgramTest {};

TEST_F(CommandLineTest, HelpAndVersionExitWithZero) {
  const Outcome program = Ballpiston({"--help"});
  EXPECT_EQ(program.code, 0);
  EXPECT_THAT(program.out, HasSubstr("Exit codes:"));
  for (const Words& words : {Words{"help"}, Words{}}) {
    EXPECT_EQ(Ballpiston(words).code, 0);
    EXPECT_EQ(Ballpiston(words).out, program.out);
  }
  const Outcome version = Ballpiston({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_THAT(version.out, ::testing::MatchesRegex("ballpiston [0-9.]+\n"));
}

TEST_F(CommandLineTest, HelpOfAVerbIsItsPage) {
  for (const Verb& verb : Verbs()) {
    Words help = absl::StrSplit(verb.name, ' '), flag = help;
    help.insert(help.begin(), "help");
    flag.push_back("--help");
    const Outcome page = Ballpiston(help);
    EXPECT_EQ(page.code, 0) << page.err;
    EXPECT_THAT(page.out, StartsWith("ballpiston " + verb.name + ": "));
    EXPECT_EQ(page.out, Ballpiston(flag).out);
  }
}

TEST_F(CommandLineTest, WrongUsageExitsWithTwoAndOneLine) {
  const Words mistakes[] = {{"dance"},
                            {"server", "dance"},
                            {"help", "dance"},
                            {"run"},
                            {"run", "first-hit", "--speed", "3"},
                            {"run", "first-hit", "--rho"},
                            {"run", "first-hit", "--rho="},
                            {"run", "first-hit", "--rho", "1", "--rho", "2"},
                            {"run", "first-hit", "--format", "xml"},
                            {"run", "first-hit", "--progress", "loud"},
                            {"run", "first-hit", "second"},
                            {"run", "first-hit", "--priority", "high"},
                            {"submit", "first-hit", "--priority", "0.5"},
                            {"submit", "brownian"},
                            {"submit", ""},
                            {"submit", "first-hit", "--request-id", "42"},
                            {"submit", "first-hit", "--request-id", ""},
                            {"watch"},
                            {"watch", "a", "--label", "run=7"},
                            {"delete", "--label", "run"},
                            {"watch", "\xc3\xa9"},
                            {"result", ""},
                            {"result", "ensembleJobs/"},
                            {"result", "a/b"},
                            {"result", "ensembleJobs/\xff"},
                            {"cancel"},
                            {"cancel", "ABC"},
                            {"delete", "a", std::string(64, 'a')},
                            {"pin"},
                            {"pin", "--undo"},
                            {"pin", "a", "B"},
                            {"result", "a", "--point", "-1"},
                            {"result", "a", "--point", "first"},
                            {"result", "a", "--save", "a.pdf"},
                            {"result", "a", "--save", "/nonexistent/a.json"},
                            {"submit", "--again", "A"},
                            {"submit", "--again", "a", "first-hit"},
                            {"plan"},
                            {"plan", "equilibrium", "--progress", "bar"},
                            {"list", "--state", "sleeping"},
                            {"list", "--since", "yesterday"},
                            {"list", "--limit", "0"},
                            {"list", "--server", "nowhere"},
                            {"list", "--server", "--ca"},
                            {"status", "now"},
                            {"analytic", "--rho", "nan"},
                            {"figure"},
                            {"figure", "portrait", "--out", "x"},
                            {"figure", "mean-free-time"},
                            {"server", "token", "ada:read"},
                            {"server", "start", "--listen", "localhost:0"}};
  for (const Words& words : mistakes) {
    const Outcome outcome = Ballpiston(words);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, StartsWith("ballpiston: "));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

TEST_F(CommandLineTest, ErrorsNameTheWrongWord) {
  const std::pair<Words, std::string> mistakes[] = {
      {{"run", "first-hit", "--rho"}, "--rho needs a value (ballpiston help run shows its usage)"},
      {{"srver", "status"}, "'srver' is not a verb; verbs are "},
      {{"server", "status", "--format", "csv"}, "--format: 'csv' is not one of table, json, jsonl"},
      {{"pin"}, "pin needs JOB: ensembleJobs/ID, or the ID alone (ballpiston help pin"},
      {{"watch"}, "name a JOB, or give --label KEY=VALUE"},
      {{"run", "first-hit", "again"}, "not expected: 'again' (ballpiston help run"},
      {{"run", "first-hit", "--rho", "1", "--rho", "2"}, "--rho is given more than once"},
      {{"--quiet", "run", "first-hit"}, "write flags after the verb: '--quiet'"},
      {{"--rho", "1", "run", "first-hit"}, "write flags after the verb: '--rho'"},
      {{"run", "first-hit", "--rho", "x", "--delta", "y"},
       "--rho: 'x' is not a decimal number such as 0.1 or 1e-3\n"},
      {{"result", "ensembleJobs/\xff\x1b"}, "JOB: 'ensembleJobs/\\xff\\x1b' is not a job's name"},
      {{"list", "--since", "31.1.2026"}, "--since: '31.1.2026' is not a date (UTC): write 2026-01"},
      {{"submit", "equilibrium", "--request-id", "42"},
       "--request-id: '42' is not a UUID like 123e4567-"}};
  for (const auto& [words, text] : mistakes) {
    EXPECT_THAT(Ballpiston(words).err, StartsWith("ballpiston: " + text));
  }
}

TEST_F(CommandLineTest, ANearNameIsSuggested) {
  const std::pair<Words, std::string> mistakes[] = {
      {{"rnu"}, "run"},
      {{"srever", "start"}, "server"},
      {{"server", "strat"}, "start"},
      {{"help", "serve", "start"}, "server start"},
      {{"run", "first-hit", "--foramt", "csv"}, "--format"},
      {{"run", "first-hit", "--sample=9"}, "--samples"},
      {{"run", "frist-hit"}, "first-hit"},
      {{"run", "first-hit", "--format", "jsno"}, "json"},
      {{"list", "--state", "running,queud"}, "queued"},
      {{"figure", "mean-free-tim", "--out", "x"}, "mean-free-time"}};
  for (const auto& [words, meant] : mistakes) {
    EXPECT_THAT(Ballpiston(words).err, HasSubstr("; did you mean " + meant + "?"));
  }
  for (const Words& words : {Words{"xyz"},
                             {"run", "first-hit", "--xyz"},
                             {"run", "first-hit", "--format", "xyz"},
                             {"run", "first-hit", "--" + std::string(100'000, 'x')}}) {
    EXPECT_THAT(Ballpiston(words).err, Not(HasSubstr("did you mean")));
  }
}

TEST_F(CommandLineTest, MessagesShortenLongWords) {
  const std::string word(100'000, 'x');
  for (const Words& words : {Words{word},
                             {"run", word},
                             {"run", "--" + word},
                             {"run", "--rho", word},
                             {"run", "--format", word},
                             {"run", "first-hit", word},
                             {"help", word},
                             {"watch", word}}) {
    const Outcome outcome = Ballpiston(words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_LT(outcome.err.size(), 600u);
  }
}

TEST_F(CommandLineTest, AfterTwoHyphensAllWordsAreArguments) {
  const auto line =
      ParseCommandLine({"server", "start", "--workers", "2", "--", "--data-dir", "x"});
  ASSERT_TRUE(line.ok()) << line.status();
  EXPECT_EQ(line->options.data_dir, "");
  EXPECT_FALSE(line->options.given.contains("--data-dir"));
  EXPECT_THAT(line->options.server_flags, ElementsAre("--data-dir", "x", "--workers", "2"));
}

// Hints contain these flags: ballpiston watch JOB --server h:1 --tls
TEST_F(CommandLineTest, TheFlagsThatChooseTheServerAreKept) {
  const auto line = ParseCommandLine({"watch", "abc", "--tls", "-q", "--server=h:1"});
  ASSERT_TRUE(line.ok()) << line.status();
  EXPECT_EQ(line->options.connection, " --server h:1 --tls");
  EXPECT_THAT(line->options.given, ElementsAre("--quiet", "--server", "--tls"));
}

// ---- notes ----

TEST_F(CommandLineTest, QuietPrintsResultsAndErrorsOnly) {
  job().set_state(v1::EnsembleJob::RUNNING);
  server_.ensemble.answers_from_store = true;
  for (const Words& words :
       {Words{"submit", "first-hit"}, {"result", "abc"}, {"cancel", "abc"}, {"run", "first-hit"}}) {
    Words quiet = words;
    quiet.push_back("-q");
    const Outcome outcome = WithServer(quiet);
    EXPECT_EQ(outcome.err, "") << words[0];
    EXPECT_NE(outcome.out, "") << words[0];
  }
  EXPECT_NE(Ballpiston({"list", "--quiet", "--limit", "0"}).err, "");
}

TEST_F(CommandLineTest, VerboseNamesServerRequestAndJob) {
  const Outcome outcome = WithServer({"submit", "first-hit", "-v"});
  EXPECT_EQ(outcome.out, "ensembleJobs/abc\n");
  const std::string id = server_.ensemble.Asked().create.at(0).request_id();
  EXPECT_EQ(outcome.err, "ballpiston: server " + server_.Address() + "\nballpiston: request id " +
                             id + "\nballpiston: job ensembleJobs/abc\n");
  EXPECT_EQ(WithServer({"submit", "first-hit"}).err, "");
}

TEST_F(CommandLineTest, ErrorsAreRedOnATerminal) {
  std::ostringstream out, err;
  Terminal terminal{.out = out, .err = err, .colour = true};
  RunCommandLine({"dance"}, terminal);
  EXPECT_THAT(err.str(), StartsWith("\x1b[1;31mballpiston:\x1b[0m 'dance'"));
}

// The server answers with bytes that are not UTF-8. Protocol Buffers would log this.
TEST_F(CommandLineTest, NoLibraryLogsToStandardError) {
  job().set_name("ensembleJobs/\xff");
  testing::internal::CaptureStderr();
  EXPECT_NE(WithServer({"submit", "first-hit"}).code, 0);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// ---- jobs ----

TEST_F(CommandLineTest, SubmitPrintsTheNameAlone) {
  EXPECT_EQ(WithServer({"submit", "first-hit", "--rho", "0.53"}),
            (Outcome{0, "ensembleJobs/abc\n", ""}));
}

TEST_F(CommandLineTest, RunPrintsTheResult) {
  const Outcome outcome = WithServer({"run", "first-hit", "--format", "csv"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("mean_hit_time,1.5,,,,,,\n"));
}

TEST_F(CommandLineTest, TablesAreRequestedWithoutHistograms) {
  WithServer({"result", "abc"});
  WithServer({"result", "abc", "--format", "json"});
  ASSERT_EQ(server_.ensemble.Asked().results.size(), 2u);
  EXPECT_EQ(server_.ensemble.Asked().results[0].view(), v1::ListResultsRequest::BASIC);
  EXPECT_EQ(server_.ensemble.Asked().results[1].view(), v1::ListResultsRequest::FULL);
}

TEST_F(CommandLineTest, ResultNotesThatAJobIsActive) {
  job().set_state(v1::EnsembleJob::RUNNING);
  job().mutable_progress()->set_points(9);
  const Outcome outcome = WithServer({"result", "ensembleJobs/abc"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("mean_hit_time"));
  EXPECT_EQ(outcome.err,
            "ballpiston: ensembleJobs/abc is still running: 1 of 9 points are finished\n");
}

TEST_F(CommandLineTest, AFailedJobExitsWithFourAndPrintsItsReasonAndPoints) {
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

TEST_F(CommandLineTest, AnUnknownJobExitsWithFive) {
  server_.ensemble.watches = {{{}, JobNotFound("ensembleJobs/none")}};
  const Outcome unknown{5, "", "ballpiston: no such job: ensembleJobs/none (JOB_NOT_FOUND)\n"};
  for (const char* verb : {"watch", "result", "pin", "delete"}) {
    EXPECT_EQ(WithServer({verb, "none"}), unknown) << verb;
  }
}

TEST_F(CommandLineTest, CancelPrintsTheStateOfEachJob) {
  EXPECT_EQ(WithServer({"cancel", "abc", "ensembleJobs/d"}),
            (Outcome{0, "ensembleJobs/abc cancelled\nensembleJobs/d cancelled\n",
                     "ensembleJobs/abc: 0 of 0 points are finished and stay\n"
                     "ensembleJobs/d: 0 of 0 points are finished and stay\n"}));
}

TEST_F(CommandLineTest, CancelOfAnEndedJobExitsWithFourAfterAllJobs) {
  WithServer({"cancel", "b"});
  EXPECT_EQ(WithServer({"cancel", "-q", "a", "b", "c"}),
            (Outcome{4, "ensembleJobs/a cancelled\nensembleJobs/c cancelled\n",
                     "ballpiston: has ended already\n"}));
}

TEST_F(CommandLineTest, PinPrintsEachJobOnceItIsPinned) {
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

TEST_F(CommandLineTest, ExpiredResultsExitWithFourAndTheCommandThatComputesThemAgain) {
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

TEST_F(CommandLineTest, DeletePrintsEachDeletedJob) {
  server_.ensemble.jobs.push_back(job());
  job().set_name("ensembleJobs/d");
  const Outcome outcome = WithServer({"delete", "abc", "d", "none"});
  EXPECT_EQ(outcome.code, 5);
  EXPECT_EQ(outcome.out, "ensembleJobs/abc deleted\nensembleJobs/d deleted\n");
}

TEST_F(CommandLineTest, LabelsSelectTheJobsOfTheServersList) {
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

TEST_F(CommandLineTest, ListRequestsGridsForJsonOnly) {
  WithServer({"list"});
  WithServer({"list", "--format", "csv"});
  WithServer({"list", "--format", "json"});
  const auto asked = server_.ensemble.Asked().list;
  ASSERT_EQ(asked.size(), 3u);
  EXPECT_EQ(asked[0].view(), v1::ListEnsembleJobsRequest::BASIC);
  EXPECT_EQ(asked[1].view(), v1::ListEnsembleJobsRequest::BASIC);
  EXPECT_EQ(asked[2].view(), v1::ListEnsembleJobsRequest::FULL);
}

TEST_F(CommandLineTest, ListSaysWhenResultsExpire) {
  const absl::Time expiry = absl::Now() + absl::Hours(3 * 24 + 12);
  job().mutable_expire_time()->set_seconds(absl::ToUnixSeconds(expiry));
  EXPECT_THAT(WithServer({"list"}).out, EndsWith("  expires in 3 days\n"));
}

TEST_F(CommandLineTest, ListSendsItsFilters) {
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

TEST_F(CommandLineTest, ListWithALimitEndsThere) {
  server_.ensemble.jobs.assign(9, job());
  const std::string out = WithServer({"list", "--limit", "3", "--format", "jsonl"}).out;
  EXPECT_EQ(std::count(out.begin(), out.end(), '\n'), 3);
  const std::string all = WithServer({"list", "--format", "jsonl"}).out;
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 9);
}

TEST_F(CommandLineTest, EscapedOrbitsAreReported) {
  server_.ensemble.points[0].mutable_health()->set_escapes(3);
  EXPECT_THAT(WithServer({"result", "abc"}).err, HasSubstr("point 0: 3 orbits left the cell"));
}

TEST_F(CommandLineTest, PlanPrintsTheLadderAndCreatesNoJob) {
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

TEST_F(CommandLineTest, AnInvalidSpecificationExitsWithTwoAndNamesTheFlagOrTheField) {
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

TEST_F(CommandLineTest, AnalyticPrintsTheAnswer) {
  server_.analytic.response.add_points()->set_rho(0.53);
  const Outcome outcome =
      WithServer({"analytic", "--rho", "0.53", "--delta", "0.1", "--format", "jsonl"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, StartsWith("{\"rho\":0.53,"));
}

TEST_F(CommandLineTest, AnalyticSendsEveryList) {
  WithServer({"analytic", "--rho", "0.53", "--delta", "0.1", "--epsilon", "0.2,0.3",
              "--outgoing-epsilon", "0.4", "--beta", "5", "--temperature", "6:8:3"});
  EXPECT_THAT(server_.analytic.asked.rho(), ElementsAre(0.53));
  EXPECT_THAT(server_.analytic.asked.delta(), ElementsAre(0.1));
  EXPECT_THAT(server_.analytic.asked.epsilon(), ElementsAre(0.2, 0.3));
  EXPECT_THAT(server_.analytic.asked.outgoing_epsilon(), ElementsAre(0.4));
  EXPECT_THAT(server_.analytic.asked.beta(), ElementsAre(5));
  EXPECT_THAT(server_.analytic.asked.temperature(), ElementsAre(6, 7, 8));
}

TEST_F(CommandLineTest, StatusPrintsTheServersAnswer) {
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

TEST_F(CommandLineTest, HelpOfAGroupNamesItsVerbs) {
  const Outcome outcome = Ballpiston({"help", "server"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("  server start "), Not(HasSubstr("analytic"))));
  EXPECT_EQ(Ballpiston({"server", "--help"}).out, outcome.out);
}

TEST_F(CommandLineTest, FigureListsItsNames) {
  EXPECT_THAT(Ballpiston({"figure", "--list"}).out, HasSubstr("mean-free-time: "));
}

// The package gets the flags as they were written, and the server in the environment.
TEST_F(CommandLineTest, FigureStartsPythonAndReturnsItsExitCode) {
  const std::string python = home_.File("python");
  WriteFile(python,
            "#!/bin/sh\necho \"$*\" $BALLPISTON_SERVER >" + home_.File("said") + "; exit 3\n");
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
