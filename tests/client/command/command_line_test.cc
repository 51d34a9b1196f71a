// The whole program without its main function: how words are read, and help. transcripts/ shows
// errors and notes.
#include "client/command/command_line.h"

#include "client/command/reference.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

using Words = std::vector<std::string>;

class CommandLineTest : public ProgramTest {};

TEST_F(CommandLineTest, TheProgramsPageIsItsHelp) {
  const Outcome program = Ballpiston({"--help"});
  EXPECT_EQ(program.code, 0);
  EXPECT_THAT(program.out, HasSubstr("Exit codes:"));
  for (const Words& words : {Words{"help"}, Words{}}) {
    EXPECT_EQ(Ballpiston(words).code, 0);
    EXPECT_EQ(Ballpiston(words).out, program.out);
  }
}

TEST_F(CommandLineTest, HelpOfAVerbIsItsShortPageOrWithAllItsWholePage) {
  for (const Verb& verb : Verbs()) {
    Words help = absl::StrSplit(verb.name, ' '), flag = help;
    help.insert(help.begin(), "help");
    flag.push_back("--help");
    EXPECT_EQ(Ballpiston(help), (Outcome{0, ShortPage(&verb), ""}));
    EXPECT_EQ(Ballpiston(flag), (Outcome{0, ShortPage(&verb), ""}));
    help.push_back("--all");
    EXPECT_EQ(Ballpiston(help), (Outcome{0, TextPage(&verb), ""}));
  }
}

TEST_F(CommandLineTest, MessagesShortenLongWords) {
  const std::string word(100'000, 'x');
  for (const Words& words : {Words{word},
                             {"run", word},
                             {"run", "--" + word},
                             {"run", "--rho", word},
                             {"run", "--rho", absl::StrReplaceAll(word, {{"x", "5,"}}) + "5"},
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

TEST_F(CommandLineTest, AWatchOfSeveralJobsPrintsEachAndReturnsTheWorst) {
  server_.jobs.push_back(job());
  job().set_name("ensembleJobs/d");
  server_.watches.push_back({{JobMessage(JobIn(v1::EnsembleJob::FAILED), "t")}, grpc::Status::OK});
  const Outcome outcome = WithServer({"watch", "abc", "d"});
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.out, AnyOf("ensembleJobs/abc succeeded\nensembleJobs/abc failed\n",
                                 "ensembleJobs/abc failed\nensembleJobs/abc succeeded\n"));
}

// The other job never ends.
TEST_F(CommandLineTest, AWatchOfAnyJobEndsWithTheFirst) {
  server_.jobs.push_back(job());
  job().set_name("ensembleJobs/d");
  server_.watches.push_back(
      {.messages = {JobMessage(JobIn(v1::EnsembleJob::RUNNING), "t")}, .hangs = true});
  const Outcome outcome = WithServer({"watch", "abc", "d", "--any"});
  EXPECT_EQ(outcome, (Outcome{0, "ensembleJobs/abc succeeded\n", ""}));
}

// The points are many requests. Nobody reads them after the first error.
TEST_F(CommandLineTest, AResultThatNobodyReadsIsNotFetched) {
  server_.points.resize(7);
  server_.Start();
  std::ostream closed(nullptr);
  std::ostringstream err;
  Terminal terminal{.out = closed, .err = err};
  RunCommandLine({"result", "abc", "--format", "jsonl", "--server", server_.Address()}, terminal);
  EXPECT_THAT(server_.Asked<v1::ListResultsRequest>(), testing::SizeIs(1)) << err.str();
}

TEST_F(CommandLineTest, AFigureWithoutItsNameIsAnErrorWithoutPython) {
  const ScopedVariable program("BALLPISTON_PYTHON", "/bin/false");
  EXPECT_THAT(Ballpiston({"figure", "--list"}).out,
              HasSubstr("\nrelaxation: Relaxation of the piston's energy"));
  EXPECT_EQ(Ballpiston({"figure", "--quick"}).code, 2);
  const Outcome wrong = Ballpiston({"figure", "mean-free-tim", "--out", "x"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean mean-free-time?"));
}

// The package gets the name, the figure's own words as they were written and the common flags. The
// server is in the environment.
TEST_F(CommandLineTest, AFigureStartsPythonAndReturnsItsExitCode) {
  const std::string python = home_.File("python");
  WriteFile(python,
            "#!/bin/sh\n[ \"$1\" = -c ] && exit 0  # the check of its modules\n"
            "echo \"$*\" $BALLPISTON_SERVER $PYTHONSAFEPATH >\"${0%/*}/said\"; exit 3\n");
  std::filesystem::permissions(python, std::filesystem::perms::owner_all);
  const ScopedVariable program("BALLPISTON_PYTHON", python);
  const ScopedVariable server("BALLPISTON_SERVER");  // the figure sets it
  const Outcome outcome =
      Ballpiston({"figure", "mean-free-time", "--out", "figures", "--quick", "--edit", "--samples",
                  "7", "--relaxation-delta", "0.1,0.2", "--server", "h:1"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_EQ(Contents(home_.File("said")),
            "-m ballpiston.figures mean-free-time --samples 7 --relaxation-delta 0.1,0.2 "
            "--out=figures --quick --edit h:1 1\n");
  WriteFile(python, "#!/bin/sh\n[ \"$1\" = -c ] || kill -9 $$\n");
  const Outcome killed = Ballpiston({"figure", "mean-free-time"});
  EXPECT_EQ(killed.code, 4);
  EXPECT_THAT(killed.err, HasSubstr("was ended by signal 9, perhaps because"));
}

// ---- exit codes ----

TEST(ExitCode, FollowsFromTheStatus) {
  using Code = absl::StatusCode;
  const std::map<int, std::vector<Code>> table = {
      {0, {Code::kOk}},
      {2, {Code::kInvalidArgument, Code::kOutOfRange, Code::kUnimplemented}},
      {3, {Code::kUnavailable, Code::kDeadlineExceeded}},
      {4, {Code::kFailedPrecondition, Code::kInternal, Code::kCancelled, Code::kResourceExhausted}},
      {5, {Code::kNotFound}},
      {6, {Code::kPermissionDenied, Code::kUnauthenticated}}};
  for (const auto& [expected, codes] : table) {
    for (const Code code : codes) {
      EXPECT_EQ(static_cast<int>(ExitCodeOf(absl::Status(code, "text"))), expected) << code;
    }
  }
}

TEST(ExitCode, OfAChildProgramIsItsStatusOrFour) {
  for (const int status : {0, 2, 3, 4, 5, 6, 130}) {
    EXPECT_EQ(static_cast<int>(ExitCodeOf(status)), status);
  }
  for (const int status : {1, 7, 127, 143}) EXPECT_EQ(ExitCodeOf(status), ExitCode::kFailed);
}

}  // namespace
}  // namespace ballpiston::client
