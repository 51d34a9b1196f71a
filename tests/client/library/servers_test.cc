// Programs that the client starts, servers of this machine, and the private server.
#include <sys/file.h>

#include "client/library/child_process.h"
#include "client/library/local_server.h"
#include "client/library/server_address.h"
#include "client/library/server_process.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// ---- child_process.h ----

int ExitCodeOfShell(const std::string& script) {
  return RunChild({.command = {"sh", "-c", script}}).value_or(-1);
}

TEST(ChildProcess, StartsWithNoSignalBlocked) {
  sigset_t sigint, old;
  sigemptyset(&sigint);
  sigaddset(&sigint, SIGINT);
  pthread_sigmask(SIG_BLOCK, &sigint, &old);
  EXPECT_EQ(ExitCodeOfShell("kill -INT $$"), 128 + SIGINT);
  pthread_sigmask(SIG_SETMASK, &old, nullptr);
}

// `nohup` starts this program with SIGHUP ignored, so that its commands go on after a logout.
TEST(ChildProcess, IgnoresSighupIfThisProgramDoes) {
  const auto old = signal(SIGHUP, SIG_IGN);
  EXPECT_EQ(ExitCodeOfShell("kill -HUP $$"), 0);
  signal(SIGHUP, old);
}

// ---- server_process.h ----

// Writes a shell script that can be run.
std::string Script(const std::string& path, const std::string& script) {
  WriteFile(path, "#!/bin/sh\n" + script + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

// A fake server as a shell script; $2 is its data folder. The server takes the lock, writes its
// process id into the lock file and writes its address. It ends at SIGTERM, or when the test's
// folder is removed, or with the test. FindServer holds a free lock for a moment, so the script
// waits for the lock. `sleep` runs in a subshell: a shell moves its own descriptor 9 while it
// starts a command without it, and FindServer could miss the descriptor.
constexpr char kLock[] = "exec 9>>$2/lock; flock 9; echo $$ >$2/lock\n";
constexpr char kListen[] = "echo unix:$2/socket >$2/server.address\n";
constexpr char kWait[] = "while [ -d $2 ] && kill -0 $PPID; do (exec sleep 0.01 9>&-); done\n";

class ServerProcessTest : public ::testing::Test {
 protected:
  ServerProcessTest() { std::filesystem::create_directory(data_); }

  ServerProgram Program(const std::string& script) const {
    return {.program = Script(folder_.File("program"), "IFS=\n" + script),  // $2 may have spaces
            .folder = data_,
            .flags = {"--flag", "a b"}};
  }

  const TemporaryFolder folder_;
  const std::string data_ = folder_.File("data");
};

TEST_F(ServerProcessTest, GetsItsFlagsInItsFolder) {
  const ScopedVariable token("BALLPISTON_TOKEN", "secret");  // not for the server
  ServerProgram program = Program("pwd >&2; printf '<%s>' \"$@\" \"$BALLPISTON_TOKEN\"; exit 1");
  EXPECT_THAT(StartServer(program), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_EQ(Contents(program.Log()), "/\n<--data-dir><" + data_ + "><--flag><a b><>");
  EXPECT_EQ(ModeOf(program.Log()), 0600u);
  EXPECT_STREQ(std::getenv("BALLPISTON_TOKEN"), "secret");
  program.run_in = data_;
  EXPECT_THAT(StartServer(program), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(Contents(program.Log()),
              HasSubstr(">" + std::filesystem::canonical(data_).string() + "\n<"));
}

TEST_F(ServerProcessTest, ErrorQuotesTheLastLineOfAProgramThatEnds) {
  const auto expect_error = [&](const std::string& script, const std::string& text) {
    EXPECT_THAT(StartServer(Program(script)),
                StatusIs(absl::StatusCode::kUnavailable, HasSubstr(text + "\n  log: " + data_)));
  };
  expect_error("echo first; echo the disk is full; exit 9",
               "ended at once with exit status 9: the disk is full");
  expect_error("exit 9", "(it wrote nothing)");
  const auto old = signal(SIGCHLD, SIG_IGN);  // the system then keeps no exit status
  expect_error("exit 9", "ended at once: (it wrote nothing)");
  signal(SIGCHLD, old);
  std::filesystem::remove(Program("").Log());
  std::filesystem::create_symlink("/dev/full", Program("").Log());
  expect_error("echo hidden; exit 1", "its log cannot be written: No space left on device");
}

TEST_F(ServerProcessTest, ErrorNamesAMissingProgram) {
  EXPECT_THAT(StartServer({.program = "/no/such/server", .folder = data_, .flags = {}}),
              StatusIs(absl::StatusCode::kUnavailable,
                       AllOf(HasSubstr("cannot start /no/such/server"),
                             HasSubstr("install the package ballpistond"))));
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

// An earlier server, which was killed, left its address. The new server removes it late.
TEST_F(ServerProcessTest, TheAddressIsThatOfTheNewServer) {
  constexpr char kLateLock[] = "exec 9>>$2/lock; flock 9; sleep 0.1; rm $2/server.address\n";
  WriteFile(data_ + "/server.address", "unix:old\n");
  EXPECT_THAT(StartServer(Program(absl::StrCat(kLateLock, "echo $$ >$2/lock\n", kListen, kWait))),
              IsOkAndHolds("unix:" + data_ + "/socket"));
  EXPECT_OK(StopServer(data_));
}

// It empties the lock's file before it releases the lock.
TEST_F(ServerProcessTest, StopWaitsUntilTheFolderIsFree) {
  ASSERT_OK(StartServer(Program(absl::StrCat(
      "trap 'rm $2/server.address; : >$2/lock; sleep 0.1; exit' TERM\n", kLock, kListen, kWait))));
  EXPECT_OK(StopServer(data_));
  EXPECT_EQ(FindServer(data_), std::nullopt);
}

TEST_F(ServerProcessTest, ErrorNamesAServerThatIsStillStopping) {
  ASSERT_OK(StartServer(Program(absl::StrCat("trap '' TERM\n", kLock, kListen, kWait))));
  const pid_t pid = FindServer(data_)->pid;
  ASSERT_GT(pid, 0);
  EXPECT_THAT(StopServer(data_, absl::Milliseconds(50)),
              StatusIs(absl::StatusCode::kDeadlineExceeded,
                       EndsWith(absl::StrCat("(process ", pid, ") is still stopping"))));
  kill(pid, SIGKILL);
  AwaitThat([&] { return kill(pid, 0) != 0; });  // it remains no zombie
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

// ---- local_server.h ----

namespace fs = std::filesystem;

// Runs with an empty HOME, and without the variables that choose the server.
class LocalServerTest : public ::testing::Test {
 protected:
  // In the home folder, with a program that runs the shell script.
  LocalServer Server(const std::string& script, absl::Duration start_time) const {
    return {.folder = home_.string(),
            .socket = home_ / "socket",
            .program = Script(home_ / "program", script),
            .start_time = start_time};
  }

  const TemporaryFolder folder_;
  const fs::path home_ = folder_.path();
  const ScopedVariable home_variable_{"HOME", home_};
  const ScopedVariable state_home_{"XDG_STATE_HOME"};
  const ScopedVariable server_program_{"BALLPISTON_SERVER_PROGRAM"};
  const ScopedVariable temporary_{"TMPDIR"};
};

TEST_F(LocalServerTest, IsInTheStateFolderOfTheUser) {
  const mode_t before = umask(0);
  ASSERT_OK_AND_ASSIGN(const LocalServer server, FindLocalServer());
  umask(before);
  EXPECT_EQ(server.folder, home_.string() + "/.local/state/ballpiston");
  EXPECT_EQ(server.socket, server.folder + "/server.socket");
  EXPECT_EQ(ModeOf(server.folder), 0700u);
  EXPECT_EQ(ModeOf(home_ / ".local"), 0700u);
  state_home_.Set((home_ / "state").string());
  EXPECT_EQ(FindLocalServer()->folder, home_.string() + "/state/ballpiston");
  state_home_.Set("relative");  // the XDG specification says: ignore it
  EXPECT_EQ(FindLocalServer()->folder, server.folder);
}

TEST_F(LocalServerTest, AStateFolderThatOthersCanChangeIsRefused) {
  const std::string folder = FindLocalServer()->folder;
  for (const mode_t mode : {0720u, 0702u}) {
    ASSERT_EQ(chmod(folder.c_str(), mode), 0);
    EXPECT_THAT(FindLocalServer(), StatusIs(absl::StatusCode::kPermissionDenied,
                                            HasSubstr("run chmod 700 " + folder)));
  }
  chmod(folder.c_str(), 0755);  // of a mkdir; the server sets it to 0700
  EXPECT_OK(FindLocalServer());
  const bool is_given = geteuid() != 65534 && chown(folder.c_str(), 65534, 65534) == 0;
  if (!is_given) GTEST_SKIP() << "only root can give a folder away";
  EXPECT_THAT(FindLocalServer(), StatusIs(absl::StatusCode::kPermissionDenied,
                                          HasSubstr("belongs to user 65534 and has mode 0755")));
}

TEST_F(LocalServerTest, APathThatGrpcCannotUseHasItsSocketInAPrivateFolderElsewhere) {
  home_variable_.Set((home_ / std::string(100, 'x')).string());
  const TemporaryFolder elsewhere("/tmp");  // a short path, whatever TMPDIR is
  temporary_.Set(elsewhere.path());
  ASSERT_OK_AND_ASSIGN(const LocalServer server, FindLocalServer());
  EXPECT_THAT(server.socket, StartsWith(elsewhere.path() + "/ballpiston-"));
  EXPECT_LE(server.socket.size(), kMaxSocketPath);
  EXPECT_EQ(FindLocalServer()->socket, server.socket);
  const fs::path folder = fs::path(server.socket).parent_path();
  EXPECT_EQ(ModeOf(folder), 0700u);
  fs::permissions(folder, fs::perms::all);  // others can enter it
  EXPECT_THAT(FindLocalServer(), StatusIs(absl::StatusCode::kPermissionDenied));
  for (const char* name : {"a#b", "a?b", "a,b", "a%20b"}) {
    state_home_.Set((home_ / name).string());
    EXPECT_THAT(FindLocalServer()->socket, StartsWith(elsewhere.path() + "/ballpiston-")) << name;
  }
}

TEST_F(LocalServerTest, ErrorNamesAStateFolderThatCannotBeMade) {
  WriteFile(home_ / "file", "not a folder");
  home_variable_.Set((home_ / "file").string());
  EXPECT_THAT(FindLocalServer(), StatusIs(absl::StatusCode::kPermissionDenied,
                                          HasSubstr(home_.string() + "/file/.local")));
}

TEST_F(LocalServerTest, TheEnvironmentCanSetTheProgram) {
  EXPECT_THAT(FindLocalServer()->program, EndsWith("ballpistond"));
  server_program_.Set("/opt/server");
  EXPECT_EQ(FindLocalServer()->program, "/opt/server");
  server_program_.Set("bin/server");
  EXPECT_EQ(FindLocalServer()->program, (fs::current_path() / "bin/server").string());
}

TEST_F(LocalServerTest, PermanentFailuresToStartKeepTheirStatus) {
  for (const auto& [program, code] : {std::pair("exit 2", absl::StatusCode::kInvalidArgument),
                                      std::pair("exit 6", absl::StatusCode::kPermissionDenied)}) {
    EXPECT_THAT(ConnectToLocalServer(Server(program, absl::FromChrono(kPatience))), StatusIs(code));
  }
}

// Holds the lock of the folder, as a server of another client does, until the file is closed.
std::shared_ptr<FILE> FolderInUse(const fs::path& folder) {
  std::shared_ptr<FILE> lock(fopen((folder / "lock").c_str(), "ae"), &fclose);
  EXPECT_EQ(flock(fileno(lock.get()), LOCK_EX | LOCK_NB), 0);
  return lock;
}

// Waits until the file exists or a stop is requested.
void AwaitFile(const fs::path& file, const std::stop_token& stop) {
  AwaitThat([&] { return fs::exists(file) || stop.stop_requested(); });
}

TEST_F(LocalServerTest, AFolderInUseIsUnavailable) {
  const auto in_use = FolderInUse(home_);
  EXPECT_THAT(ConnectToLocalServer(Server("exit 2", absl::Seconds(1))),
              StatusIs(absl::StatusCode::kUnavailable));
}

TEST_F(LocalServerTest, DoesNotWaitForAServerThatListensElsewhere) {
  const auto in_use = FolderInUse(home_);
  WriteFile(home_ / "server.address", "127.0.0.1:50051\n");
  EXPECT_THAT(ConnectToLocalServer(Server("echo why; exit 2", absl::FromChrono(kUnreachedLimit))),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("listens at 127.0.0.1:50051")));
}

// The other server ends: the program is started again, and runs until the test's folder is removed
// or the test ends.
TEST_F(LocalServerTest, StartsAServerWhenAnotherLeavesTheFolder) {
  FakeServer second;
  auto in_use = FolderInUse(home_);
  LocalServer server = Server(
      absl::StrCat("cd \"${0%/*}\"; if [ -e once ]; then exec 9>>lock; flock 9; echo $$ >lock; ",
                   "echo unix:", second.SocketPath(), " >server.address; touch twice; ",
                   "while [ -e once ] && kill -0 $PPID; do (exec sleep 0.01 9>&-); done; ",
                   "exit 1; fi; touch once; exit 1"),
      absl::FromChrono(kPatience));
  server.socket = second.SocketPath();
  std::jthread starter([&](const std::stop_token& stop) {
    AwaitFile(home_ / "once", stop);
    in_use.reset();
    AwaitFile(home_ / "twice", stop);
    second.Start();
  });
  EXPECT_OK(ConnectToLocalServer(server));
  starter.request_stop();
  starter.join();
}

}  // namespace
}  // namespace ballpiston::client
