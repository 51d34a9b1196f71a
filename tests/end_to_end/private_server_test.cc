// The private server, which the client starts itself.
#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

const Words kRun = Split("run equilibrium --rho 0.53 --delta 0.2 --collisions 1000 --format json");
const Words kList = Split("list --format json");

// An empty home; the private servers that were started there end with the test.
class PrivateServerTest : public ::testing::Test {
 protected:
  ~PrivateServerTest() override {
    for (const int pid : Servers()) kill(pid, SIGKILL);
  }

  ProcessOptions Command(const Words& words) const { return ClientCommand(home_, words); }
  ProcessResult Client(const Words& words) const { return RunProgram(Command(words)); }
  std::string State(const std::string& name) const {
    return home_.File(".local/state/ballpiston/" + name);
  }

  int CountInLog(const std::string& text) const {
    std::ifstream log(State("server.log"));
    int count = 0;
    for (std::string line; std::getline(log, line);) count += line.find(text) != std::string::npos;
    return count;
  }

  // Processes whose command line names this test's home.
  std::vector<int> Servers() const {
    std::vector<int> pids;
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const std::string line = Contents(entry.path() / "cmdline");
      const bool is_server = line.find("ballpistond") != std::string::npos;
      if (is_server && line.find(home_.path()) != std::string::npos) {
        pids.push_back(std::atoi(entry.path().filename().c_str()));
      }
    }
    return pids;
  }

  TemporaryFolder home_;
};

TEST(Server, StopsWhenItIsIdle) {
  const TemporaryFolder home;
  const ProcessResult result =
      RunServer(home, {"--listen", "unix:" + home.File("socket"), "--data-dir", home.File("data"),
                       "--idle-exit-seconds", "0.1"});
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.err, testing::HasSubstr("the server is idle: stopping"));
}

TEST_F(PrivateServerTest, OneCommandDoesTheJobInAnEmptyHome) {
  const ProcessResult result = Client(kRun);
  ASSERT_THAT(result, ExitsWith(0));
  EXPECT_EQ(At(ParseJson(result.out), "job", "state").string_value(), "SUCCEEDED");
  EXPECT_TRUE(fs::exists(State("server.log")));
  EXPECT_EQ(fs::status(State("")).permissions(), fs::perms::owner_all);
  ASSERT_EQ(Servers().size(), 1u);
  const std::string flags = Contents("/proc/" + std::to_string(Servers()[0]) + "/cmdline");
  EXPECT_NE(flags.find(std::string("--idle-exit-seconds\0"
                                   "60\0",
                                   23)),
            std::string::npos);
}

// A client uses the lock and the address to see that a server is starting or stopping, and the
// process id to stop it.
TEST_F(PrivateServerTest, AServerLocksItsFolderAndWritesItsIdAndAddressThere) {
  ASSERT_THAT(Client(kRun), ExitsWith(0));
  const int lock = open(State("lock").c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_GE(lock, 0);
  EXPECT_NE(flock(lock, LOCK_SH | LOCK_NB), 0);
  EXPECT_EQ(errno, EWOULDBLOCK);
  close(lock);
  ASSERT_EQ(Servers().size(), 1u);
  EXPECT_EQ(Contents(State("lock")), std::to_string(Servers()[0]) + "\n");
  EXPECT_EQ(Contents(State("server.address")), "unix:" + State("server.socket") + "\n");
}

TEST_F(PrivateServerTest, ManyClientsAtOnceEndUpOnOneServer) {
  const ProcessOptions run = Command(Joined({kRun, {"--fresh"}}));  // each run creates a job
  std::vector<std::unique_ptr<Process>> clients;
  for (int i = 0; i < 6; ++i) clients.push_back(std::make_unique<Process>(run));
  for (const auto& client : clients) {
    const ProcessResult result = client->Wait();
    EXPECT_THAT(result, ExitsWith(0));
  }
  const ProcessResult list = Client(kList);
  EXPECT_EQ(Length(At(ParseJson(list.out), "jobs")), 6);
  EXPECT_EQ(CountInLog("listening on"), 1);  // other servers may still be ending
}

// A dead server leaves its socket behind.
TEST_F(PrivateServerTest, AKilledServerIsReplacedAndItsJobsAreThere) {
  ASSERT_THAT(Client(kRun), ExitsWith(0));
  for (const int pid : Servers()) kill(pid, SIGKILL);
  EXPECT_TRUE(fs::exists(State("server.socket")));
  const ProcessResult list = Client(kList);
  ASSERT_THAT(list, ExitsWith(0));
  EXPECT_EQ(At(ParseJson(list.out), "jobs", 0, "state").string_value(), "SUCCEEDED");
}

// The watching client starts the server again. The server resumes the job.
TEST_F(PrivateServerTest, TheWatchingClientStartsAKilledServerAgain) {
  Process run(
      Command(Split("run equilibrium --rho 0.53 --delta 0.2,0.1 --collisions 300000 "
                    "--verify --progress json --format json")));
  const std::string line = run.WaitForErrLine([](const std::string& text) {
    return At(ParseJson(text), "progress", "samples").number_value() > 0;
  });
  ASSERT_NE(line, "");
  for (const int pid : Servers()) kill(pid, SIGKILL);
  const ProcessResult result = run.Wait();
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(Length(At(ParseJson(result.out), "points")), 2);
}

TEST_F(PrivateServerTest, StatusAsksTheRunningServerAndStartsNone) {
  const ProcessResult none = Client({"status"});
  EXPECT_THAT(none, ExitsWith(3));
  EXPECT_THAT(none.err, HasSubstr("no private server is running"));
  EXPECT_TRUE(Servers().empty());
  EXPECT_FALSE(fs::exists(State("server.log")));

  ASSERT_THAT(Client(kRun), ExitsWith(0));
  const ProcessResult one = Client({"status", "--format", "json"});
  EXPECT_THAT(one, ExitsWith(0));
  EXPECT_EQ(At(ParseJson(one.out), "stored_jobs").number_value(), 1);
}

}  // namespace
}  // namespace ballpiston
