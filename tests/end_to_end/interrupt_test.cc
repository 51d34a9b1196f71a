// Ctrl-C, SIGTERM and SIGHUP while the client submits or watches a job: the client ends at once,
// and the job continues.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::AnyOf;

class InterruptTest : public ::testing::Test {
 protected:
  void ExpectThatTheJobGoesOn() const {
    EXPECT_THAT(server_.List().jobs().at(0).state(),
                AnyOf(v1::EnsembleJob::QUEUED, v1::EnsembleJob::RUNNING));
  }

  // A run that takes years.
  static Words EndlessRun(const std::string& flags) {
    return Joined({{"run"}, kEndlessQuestion, Split(flags)});
  }
  ProcessOptions EndlessRunOnATerminal() const {
    ProcessOptions options = server_.Command(EndlessRun(""));
    options.on_terminal = true;
    return options;
  }

  const TestServer server_;
};

TEST_F(InterruptTest, EachSignalEndsTheClientAndTheJobGoesOn) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Process run(server_.Command(EndlessRun("--progress json --format csv")));
    const std::string line = run.WaitForErrLine([](const std::string&) { return true; });
    const std::string job = FromJson<file::v1::WatchProgress>(line).job();
    run.Signal(signal);
    const ProcessResult result = run.Wait();
    EXPECT_THAT(result, ExitsWith(130));
    EXPECT_EQ(result.out, "");
    const std::string flags = job + " --server ";  // then the quoted address
    EXPECT_THAT(result.err, HasSubstr("ballpiston watch " + flags));
    EXPECT_THAT(result.err, HasSubstr("ballpiston cancel " + flags));
    for (const auto text : absl::StrSplit(result.err, '\n', absl::SkipEmpty())) {
      EXPECT_EQ(FromJson<file::v1::WatchProgress>(std::string(text)).job(), job);
    }
    ExpectThatTheJobGoesOn();
    EXPECT_THAT(server_.Client({"cancel", job}), ExitsWith(0));
  }
}

// The message replaces the bar. It is the last output, however often Ctrl-C was pressed.
TEST_F(InterruptTest, OnATerminalTheMessageReplacesTheBar) {
  for (const std::string presses : {"\x03", "\x03\x03"}) {
    Process run(EndlessRunOnATerminal());
    ASSERT_TRUE(run.WaitForOut("0/1 points"));
    run.Type(presses);
    const ProcessResult result = run.Wait();
    EXPECT_THAT(result, ExitsWith(130));
    const size_t message = result.out.find("\r\x1b[KThe job continues.\r\n");
    ASSERT_NE(message, std::string::npos) << result.out;
    EXPECT_EQ(result.out.find("points", message), std::string::npos) << result.out;
    EXPECT_THAT(result.out,
                AnyOf(EndsWith(server_.address() + "\r\n"), EndsWith(server_.address() + "'\r\n")));
    ExpectThatTheJobGoesOn();
  }
}

// The server is stopped: it receives the job, but does not answer.
TEST_F(InterruptTest, DuringASubmissionTheMessageHasTheRequestId) {
  const std::string id = "123e4567-e89b-12d3-a456-426614174000";
  server_.Signal(SIGSTOP);
  Process submit(
      server_.Command(Joined({{"submit", "--verbose", "--request-id", id}, kQuickQuestion})));
  ASSERT_TRUE(submit.WaitForErr("request id " + id + "\n"));
  submit.Signal(SIGINT);
  const ProcessResult result = submit.Wait();
  server_.Signal(SIGCONT);
  EXPECT_THAT(result, ExitsWith(130));
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, EndsWith("\nThe server may have accepted the job. With --request-id " +
                                   id + " the same command returns this job.\n"));
}

TEST_F(InterruptTest, AClosedTerminalEndsTheClientAndTheJobGoesOn) {
  Process run(EndlessRunOnATerminal());
  ASSERT_TRUE(run.WaitForOut("0/1 points"));
  run.CloseTerminal();
  EXPECT_THAT(run.Wait(), ExitsWith(130));
  ExpectThatTheJobGoesOn();
}

}  // namespace
}  // namespace ballpiston
