#include "client/library/server_process.h"

#include <signal.h>

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// A fake server as a shell script; $2 is its data folder. The server takes the lock, writes its
// process id into the lock file and writes its address. It ends at SIGTERM, or when the test's
// folder is removed. FindServer holds a free lock for a moment, so the script waits for the lock.
constexpr char kLock[] = "exec 9>>$2/lock; flock -w 1 9 || exit 1; echo $$ >$2/lock\n";
constexpr char kListen[] = "echo unix:$2/socket >$2/server.address\n";
constexpr char kWait[] = "while [ -d $2 ]; do sleep 0.01 9>&-; done\n";
constexpr char kEnd[] = "trap 'rm $2/server.address; exit 0' TERM\n";

class ServerProcessTest : public ::testing::Test {
 protected:
  ServerProcessTest() { std::filesystem::create_directory(data_); }

  ServerProgram Program(const std::string& script) const {
    WriteFile(folder_.File("program"), "#!/bin/sh\n" + script);
    std::filesystem::permissions(folder_.File("program"), std::filesystem::perms::owner_all);
    return {.program = folder_.File("program"), .folder = data_, .flags = {"--flag", "a b"}};
  }
  ServerProgram Server() const { return Program(absl::StrCat(kLock, kEnd, kListen, kWait)); }

  const TemporaryFolder folder_;
  const std::string data_ = folder_.File("data");
};

TEST_F(ServerProcessTest, IsStartedFoundAndStopped) {
  EXPECT_EQ(FindServer(data_), std::nullopt);
  EXPECT_THAT(StartServer(Server()), IsOkAndHolds("unix:" + data_ + "/socket"));
  const auto server = FindServer(data_);
  ASSERT_TRUE(server.has_value());
  EXPECT_EQ(absl::StrCat(server->pid, "\n"), Contents(data_ + "/lock"));
  EXPECT_EQ(server->address, "unix:" + data_ + "/socket");
  EXPECT_OK(StopServer(data_));
  EXPECT_EQ(FindServer(data_), std::nullopt);
  EXPECT_FALSE(std::filesystem::exists(data_ + "/server.address"));
}

TEST_F(ServerProcessTest, GetsItsFlagsInItsFolder) {
  ServerProgram program = Program("pwd; printf '<%s>' \"$@\"; exit 1");
  EXPECT_THAT(StartServer(program), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_EQ(Contents(program.Log()), "/\n<--data-dir><" + data_ + "><--flag><a b>");
  program.run_in = data_;
  EXPECT_THAT(StartServer(program), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(Contents(program.Log()), HasSubstr(">" + data_ + "\n<"));
}

TEST_F(ServerProcessTest, ErrorQuotesTheLastLineOfAProgramThatEnds) {
  EXPECT_THAT(
      StartServer(Program("echo first; echo the disk is full; exit 9")),
      StatusIs(absl::StatusCode::kUnavailable,
               HasSubstr("ended at once with exit status 9: the disk is full\n  log: " + data_)));
  EXPECT_THAT(StartServer(Program("exit 9")),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("(it wrote nothing)")));
}

TEST_F(ServerProcessTest, ErrorNamesAMissingProgram) {
  EXPECT_THAT(StartServer({.program = "/no/such/server", .folder = data_, .flags = {}}),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("cannot start /no/such/server")));
}

// Two clients may start a server at the same time.
TEST_F(ServerProcessTest, StartReturnsTheAddressOfAnEarlierServer) {
  ASSERT_OK_AND_ASSIGN(const std::string first, StartServer(Server()));
  EXPECT_THAT(StartServer(Server()), IsOkAndHolds(first));
  EXPECT_OK(StopServer(data_));
}

TEST_F(ServerProcessTest, AServerThatDoesNotListenIsFoundAndReported) {
  EXPECT_THAT(StartServer(Program(absl::StrCat(kLock, kWait)), absl::Milliseconds(100)),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("does not answer")));
  std::optional<RunningServer> server;
  AwaitThat([&] {
    server = FindServer(data_);
    return server && server->pid != 0;
  });
  EXPECT_EQ(server->address, "");
  EXPECT_OK(StopServer(data_));
}

TEST_F(ServerProcessTest, ErrorNamesAServerThatIsStillStopping) {
  ASSERT_OK(StartServer(Program(absl::StrCat("trap '' TERM\n", kLock, kListen, kWait))));
  const pid_t pid = FindServer(data_)->pid;
  ASSERT_GT(pid, 0);
  EXPECT_THAT(StopServer(data_, absl::Milliseconds(50)),
              StatusIs(absl::StatusCode::kDeadlineExceeded,
                       EndsWith(absl::StrCat("(process ", pid, ") is still stopping"))));
  kill(pid, SIGKILL);
}

TEST_F(ServerProcessTest, WithoutAServerNothingIsStopped) {
  EXPECT_THAT(StopServer(data_),
              StatusIs(absl::StatusCode::kUnavailable, "no server runs in " + data_));
  WriteFile(data_ + "/lock", absl::StrCat(getpid(), "\n"));  // of a server that was killed
  WriteFile(data_ + "/server.address", "unix:old\n");
  EXPECT_EQ(FindServer(data_), std::nullopt);
  EXPECT_THAT(StopServer(data_), StatusIs(absl::StatusCode::kUnavailable));
}

TEST_F(ServerProcessTest, ALongLogIsRenamed) {
  const ServerProgram program = Program("echo new; exit 1");
  WriteFile(program.Log(), std::string(2 << 20, 'x'));
  EXPECT_THAT(StartServer(program), StatusIs(absl::StatusCode::kUnavailable,
                                             HasSubstr("ended at once with exit status 1: new\n")));
  EXPECT_EQ(Contents(program.Log()), "new\n");
  EXPECT_EQ(Contents(program.Log() + ".old").size(), size_t{2 << 20});
}

}  // namespace
}  // namespace ballpiston::client
