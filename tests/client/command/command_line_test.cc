// The whole program without its main function: how words are read, errors, help and notes.
#include "client/command/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_split.h"
#include "tests/client/program.h"

namespace ballpiston::client {
namespace {

using ::testing::ElementsAre;
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

}  // namespace
}  // namespace ballpiston::client
