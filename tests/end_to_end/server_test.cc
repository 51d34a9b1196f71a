// Servers of this machine: the private server, which the client starts itself, and those of
// `ballpiston server`.
#include <fcntl.h>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

const Words kRun = Split("run equilibrium --rho 0.53 --delta 0.2 --collisions 1000 --format json");

// An empty home; the servers that were started there end with the test.
class ServerTest : public ::testing::Test {
 protected:
  ~ServerTest() override { KillServers(); }

  ProcessResult Client(const Words& words) const { return RunProgram(ClientCommand(home_, words)); }
  ProcessResult Server(const std::string& verb, const Words& flags = {}) const {
    return Client(Joined({{"server", verb}, flags}));
  }
  std::string State(const std::string& name) const {
    return home_.File(".local/state/ballpiston/" + name);
  }

  // Those whose command line names this test's home.
  std::vector<pid_t> Servers() const {
    std::vector<pid_t> servers = ProcessesWith(home_.path());
    std::erase_if(servers, [](pid_t process) {
      const std::string words = Contents(absl::StrCat("/proc/", process, "/cmdline"));
      return !absl::StrContains(words, "ballpistond");
    });
    return servers;
  }
  void KillServers() const {
    for (const pid_t server : Servers()) kill(server, SIGKILL);
  }

  const TemporaryFolder home_;
  const Words named_ = {"--data-dir", home_.File("data")};  // not the private server's folder
};

TEST_F(ServerTest, OneCommandDoesTheJobInAnEmptyHome) {
  const ProcessResult result = Client(kRun);
  ASSERT_THAT(result, ExitsWith(0));
  EXPECT_EQ(FromJson<file::v1::SavedResult>(result.out).job().state(), v1::EnsembleJob::SUCCEEDED);
  EXPECT_TRUE(fs::exists(State("server.log")));
  EXPECT_EQ(ModeOf(State("")), 0700u);
  EXPECT_EQ(ModeOf(State("server.socket")) & 077u, 0u);
  ASSERT_EQ(Servers().size(), 1u);
  const std::string flags = Contents("/proc/" + std::to_string(Servers()[0]) + "/cmdline");
  EXPECT_THAT(flags, HasSubstr(std::string("--idle-exit-seconds\0"
                                           "60\0",
                                           23)));
}

TEST_F(ServerTest, AnIdleServerStops) {
  const ProcessResult result = RunServer(
      home_,
      Joined({named_, {"--listen", "unix:" + home_.File("s"), "--idle-exit-seconds", "0.1"}}));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.err, HasSubstr("the server is idle: stopping"));
}

TEST_F(ServerTest, ManyClientsAtOnceEndUpOnOnePrivateServer) {
  const ProcessOptions run = ClientCommand(home_, Joined({kRun, {"--fresh"}}));
  std::vector<std::unique_ptr<Process>> clients;
  for (int i = 0; i < 6; ++i) clients.push_back(std::make_unique<Process>(run));
  for (const auto& client : clients) EXPECT_THAT(client->Wait(), ExitsWith(0));
  const ProcessResult list = Client({"list", "--format", "json"});
  EXPECT_EQ(FromJson<v1::ListEnsembleJobsResponse>(list.out).jobs_size(), 6);
  // Other servers may still be ending.
  const Words listening = absl::StrSplit(Contents(State("server.log")), "listening on");
  EXPECT_THAT(listening, SizeIs(2));
}

// The killed server leaves its socket behind. The new one resumes the job.
TEST_F(ServerTest, AWatchingClientStartsAKilledPrivateServerAgain) {
  Process run(ClientCommand(
      home_, Split("run equilibrium --rho 0.53 --delta 0.2,0.1 --collisions 300000 --verify "
                   "--progress json --format json")));
  const std::string line = run.WaitForErrLine([](const std::string& text) {
    return FromJson<file::v1::WatchProgress>(text).progress().samples() > 0;
  });
  ASSERT_NE(line, "");
  KillServers();
  EXPECT_TRUE(fs::exists(State("server.socket")));
  const ProcessResult result = run.Wait();
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(FromJson<file::v1::SavedResult>(result.out).points_size(), 2);
}

TEST_F(ServerTest, ThePrivateServerIsStartedFoundAndStopped) {
  const std::pair<const char*, const char*> without_server[] = {
      {"server stop", "no server runs in "}, {"status", "no private server is running"}};
  for (const auto& [words, message] : without_server) {
    const ProcessResult none = Client(Split(words));
    EXPECT_THAT(none, ExitsWith(3));
    EXPECT_THAT(none.err, HasSubstr(message));
    EXPECT_FALSE(fs::exists(State("server.log")));  // none was started
  }
  // Its output ends when the command ends: the server does not keep the pipe open.
  ProcessOptions start = ClientCommand(home_, Split("server start -- --idle-exit-seconds 1000"));
  start.command.insert(start.command.begin(),
                       {"bash", "-o", "pipefail", "-c", "\"$@\" 2>&1 | cat", "bash"});
  const ProcessResult started = RunProgram(start);
  EXPECT_THAT(started, ExitsWith(0));
  EXPECT_EQ(started.out, "unix:" + State("server.socket") + "\n");
  const ProcessResult again = Server("start");
  EXPECT_EQ(again.out, started.out);
  EXPECT_THAT(again.err, HasSubstr("already runs there"));
  // The flag would have no effect.
  const ProcessResult refused = Server("start", {"--workers", "1"});
  EXPECT_THAT(refused, ExitsWith(4));
  EXPECT_THAT(refused.err, HasSubstr(State("server.socket")));
  EXPECT_THAT(Server("status"), ExitsWith(0));
  EXPECT_THAT(Server("stop"), ExitsWith(0));
  EXPECT_THAT(Server("status"), ExitsWith(3));
}

TEST_F(ServerTest, AServerInAFolderIsStartedCheckedCopiedAndStopped) {
  const ProcessResult started =
      Server("start", Joined({named_, Split("--workers 1 --listen 127.0.0.1:0")}));
  EXPECT_THAT(started, ExitsWith(0));
  EXPECT_THAT(started.out, StartsWith("127.0.0.1:"));
  EXPECT_THAT(Contents(home_.File("data/server.log")), Not(HasSubstr("sets its mode")));
  const std::string address = started.out.substr(0, started.out.find('\n'));
  EXPECT_THAT(Server("status", {"--server", address}).out, HasSubstr("0 of 1 busy"));
  EXPECT_THAT(Server("check", named_).out, HasSubstr("sound"));
  const Words backup = Joined({{home_.File("copy")}, named_});
  EXPECT_THAT(Server("backup", backup), ExitsWith(0));
  EXPECT_TRUE(fs::exists(home_.File("copy")));
  EXPECT_THAT(Server("backup", backup), Not(ExitsWith(0)));  // the file exists
  EXPECT_THAT(Server("stop", named_), ExitsWith(0));
  EXPECT_EQ(Contents(home_.File("data/lock")), "");
  EXPECT_FALSE(fs::exists(home_.File("data/server.address")));
}

TEST_F(ServerTest, AServerWithoutStandardErrorCanBeStopped) {
  ProcessOptions command = ServerCommand(home_, named_);
  command.command.insert(command.command.begin(), {"sh", "-c", "exec \"$@\" 2>&-", "sh"});
  const Process server(command);
  AwaitThat([this] { return fs::exists(home_.File("data/server.address")); });
  EXPECT_THAT(Server("stop", named_), ExitsWith(0));
  EXPECT_EQ(Contents(home_.File("data/lock")), "");  // no log
}

// The lock file of a folder that another machine uses holds the number of a process of that
// machine.
TEST_F(ServerTest, StopIgnoresProcessesThatDoNotUseTheFolder) {
  fs::create_directory(home_.File("data"));
  const std::string lock = home_.File("data/lock");
  Process stranger({.command = {"sleep", "infinity"}});
  WriteFile(lock, std::to_string(stranger.pid()) + "\n");
  Process holder({.command = {"flock", "--no-fork", lock, "sh", "-c",
                              "echo locked >&2; exec sleep infinity"}});
  ASSERT_TRUE(holder.WaitForErr("locked"));
  const ProcessResult result = Server("stop", named_);
  EXPECT_THAT(result, ExitsWith(3));
  EXPECT_THAT(result.err, HasSubstr("is on another machine"));
  EXPECT_EQ(kill(stranger.pid(), 0), 0);
}

// Reads everything that is in the pipe.
std::string ReadAll(int pipe) {
  std::string text;
  char block[4096];
  for (ssize_t n = 0; (n = read(pipe, block, sizeof(block))) > 0;) {
    text.append(block, static_cast<size_t>(n));
  }
  return text;
}

TEST(ServerLog, TheServerGoesOnWhenNobodyReadsItsLog) {
  const TemporaryFolder home;
  ASSERT_EQ(mkfifo(home.File("log").c_str(), 0600), 0);
  const int log = open(home.File("log").c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  const std::string block(4096, 'x');
  while (write(log, block.data(), block.size()) > 0) continue;  // until the pipe is full
  ServerProcess server({.flags = {"--drain-seconds", "1"},
                        .launcher = {"sh", "-c", "exec \"$@\" 2>\"$0\"", home.File("log")}});
  server.Spawn();
  const auto ask = [&](const std::string& words) {
    return RunProgram(ClientCommand(home, Split(words + " --server " + server.address())));
  };
  AwaitThat([&] { return ask("status").exit_code == 0; });  // until the server listens
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(ask("run equilibrium --rho 0.53 --delta 0.2 --collisions 100"), ExitsWith(0));
  }
  ReadAll(log);
  EXPECT_EQ(server.Stop(), 0);
  EXPECT_THAT(ReadAll(log), HasSubstr("warning: lines were dropped: the log was not read or "
                                      "could not be written (lines="));
  close(log);
}

}  // namespace
}  // namespace ballpiston
