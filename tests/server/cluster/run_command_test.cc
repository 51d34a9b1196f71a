#include "server/cluster/run_command.h"

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

constexpr std::chrono::milliseconds kShort(50);
// Longer than any test: a program that sleeps so long is killed.
constexpr char kForever[] = "sleep 1000";

Command Shell(const std::string& script) {
  return {.words = {"sh", "-c", script},
          .environment = {"PATH=/usr/bin:/bin"},
          .limit = kUnreachedLimit};
}

absl::StatusOr<CommandOutput> RunShell(const std::string& script) {
  return RunCommand(Shell(script), {});
}

TEST(RunCommand, GivesOutputErrorsAndExitCode) {
  const struct {
    const char* script;
    const char* output;
    const char* errors;
    int exit_code;
  } rows[] = {{"echo a; echo b >&2; exit 3", "a\n", "b\n", 3},
              {"exit 0", "", "", 0},
              {"exit 255", "", "", 255},
              {"kill -KILL $$", "", "", 128 + SIGKILL},
              {"kill -TERM $$", "", "", 128 + SIGTERM}};
  for (const auto& [script, output, errors, exit_code] : rows) {
    ASSERT_OK_AND_ASSIGN(const CommandOutput run, RunShell(script));
    EXPECT_EQ(run.output, output) << script;
    EXPECT_EQ(run.errors, errors) << script;
    EXPECT_EQ(run.exit_code, exit_code) << script;
  }
}

TEST(RunCommand, AProgramThatCannotBeRunIsAnError) {
  EXPECT_THAT(RunCommand({.words = {"no-such-program-4711"}, .limit = kUnreachedLimit}, {}),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("no-such-program-4711")));
  const TemporaryFolder folder;
  WriteFile(folder.File("text"), "text");
  EXPECT_THAT(RunCommand({.words = {folder.File("text")}, .limit = kUnreachedLimit}, {}),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr(folder.File("text"))));
}

TEST(RunCommand, TheProgramHasTheGivenEnvironmentAlone) {
  Command command = Shell("env");
  command.environment = {"PATH=/usr/bin:/bin", "ONE=1", "TWO=a b"};
  ASSERT_OK_AND_ASSIGN(const CommandOutput run, RunCommand(command, {}));
  EXPECT_THAT(run.output, HasSubstr("ONE=1\n"));
  EXPECT_THAT(run.output, HasSubstr("TWO=a b\n"));
  EXPECT_THAT(run.output, ::testing::Not(HasSubstr("HOME=")));
}

TEST(RunCommand, TheInputIsEmpty) { EXPECT_EQ(RunShell("cat")->output, ""); }

// More than the pipes hold, on both at the same time.
TEST(RunCommand, LargeOutputsAreWhole) {
  constexpr size_t kBytes = 3'000'000;
  const std::string large = absl::StrCat("head -c ", kBytes, " /dev/zero");
  ASSERT_OK_AND_ASSIGN(const CommandOutput run, RunShell(large + " >&2 & " + large + "; wait"));
  EXPECT_EQ(run.output.size(), kBytes);
  EXPECT_EQ(run.errors.size(), kBytes);
}

TEST(RunCommand, TheProgramIsKilledAtTheLimit) {
  for (const char* before : {"", "exec >&- 2>&-; "}) {  // also if it has closed its output
    Command command = Shell(absl::StrCat(before, "exec ", kForever));
    command.limit = kShort;
    EXPECT_THAT(RunCommand(command, {}),
                StatusIs(absl::StatusCode::kDeadlineExceeded, HasSubstr("sh")));
  }
}

TEST(RunCommand, TheProgramIsKilledWhenStopIsRequested) {
  const TemporaryFolder folder;
  const std::string pid_file = folder.File("pid");
  Command command = Shell(absl::StrCat("echo $$ >", pid_file, "; exec ", kForever));
  std::stop_source stop;
  std::thread stopper([&] {
    AwaitThat([&] { return !Contents(pid_file).empty(); });
    stop.request_stop();
  });
  EXPECT_THAT(RunCommand(command, stop.get_token()), StatusIs(absl::StatusCode::kCancelled));
  stopper.join();
  EXPECT_NE(kill(std::stoi(Contents(pid_file)), 0), 0);
}

// The server blocks some signals and ignores SIGPIPE; the program gets the usual handling.
TEST(RunCommand, TheProgramHasTheUsualSignals) {
  sigset_t usr1, before;
  sigemptyset(&usr1);
  sigaddset(&usr1, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &usr1, &before);
  void (*const pipe)(int) = signal(SIGPIPE, SIG_IGN);
  EXPECT_EQ(RunShell("kill -USR1 $$; exit 0")->exit_code, 128 + SIGUSR1);
  EXPECT_EQ(RunShell("kill -PIPE $$; exit 0")->exit_code, 128 + SIGPIPE);
  signal(SIGPIPE, pipe);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace
}  // namespace ballpiston::server
