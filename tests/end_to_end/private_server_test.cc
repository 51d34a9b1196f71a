// The server that nobody has to start.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/end_to_end/programs.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::vector<std::string> kRun = {"run", "equilibrium",  "--rho", "0.53",     "--delta",
                                       "0.2", "--collisions", "1000",  "--format", "json"};

// An empty home; the private servers that were started there end with the test.
class PrivateServerTest : public ::testing::Test {
 protected:
  ~PrivateServerTest() override {
    for (const int pid : Servers()) kill(pid, SIGKILL);
  }

  ProcessOptions Client(std::vector<std::string> words) const {
    words.insert(words.begin(), ClientProgram());
    return {.command = std::move(words), .environment = CleanEnvironment(home_), .input = ""};
  }
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
      std::ifstream file(entry.path() / "cmdline");
      const std::string line((std::istreambuf_iterator<char>(file)),
                             std::istreambuf_iterator<char>());
      const bool is_server = line.find("ballpistond") != std::string::npos;
      if (is_server && line.find(home_.path()) != std::string::npos) {
        pids.push_back(std::atoi(entry.path().filename().c_str()));
      }
    }
    return pids;
  }

  TemporaryFolder home_;
};

TEST_F(PrivateServerTest, OneCommandDoesTheJobInAnEmptyHome) {
  const ProcessResult result = RunProgram(Client(kRun));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(At(ParseJson(result.out), "job", "state").string_value(), "SUCCEEDED");
  EXPECT_TRUE(fs::exists(State("server.log")));
  EXPECT_EQ(fs::status(State("")).permissions(), fs::perms::owner_all);
  EXPECT_EQ(Servers().size(), 1u);
}

// By these a client tells that a server is on its way, or on its way out.
TEST_F(PrivateServerTest, AServerHoldsItsFoldersLockAndTellsItsAddress) {
  ASSERT_EQ(RunProgram(Client(kRun)).exit_code, 0);
  const int lock = open(State("lock").c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_GE(lock, 0);
  EXPECT_NE(flock(lock, LOCK_SH | LOCK_NB), 0);
  EXPECT_EQ(errno, EWOULDBLOCK);
  close(lock);
  std::string address;
  std::getline(std::ifstream(State("server.address")), address);
  EXPECT_EQ(address, "unix:" + State("server.socket"));
}

TEST_F(PrivateServerTest, TheNextCommandFindsTheSameServer) {
  ASSERT_EQ(RunProgram(Client(kRun)).exit_code, 0);
  const std::vector<int> before = Servers();
  const ProcessResult list = RunProgram(Client({"list", "--format", "json"}));
  EXPECT_EQ(At(ParseJson(list.out), "jobs").list_value().values_size(), 1);
  EXPECT_EQ(Servers(), before);
}

TEST_F(PrivateServerTest, ManyClientsAtOnceEndUpOnOneServer) {
  std::vector<std::string> words = kRun;
  words.push_back("--fresh");  // each wants an answer of its own
  std::vector<std::unique_ptr<Process>> clients;
  for (int i = 0; i < 6; ++i) clients.push_back(std::make_unique<Process>(Client(words)));
  for (const auto& client : clients) {
    const ProcessResult result = client->Wait();
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
  const ProcessResult list = RunProgram(Client({"list", "--format", "json"}));
  EXPECT_EQ(At(ParseJson(list.out), "jobs").list_value().values_size(), 6);
  EXPECT_EQ(CountInLog("listening on"), 1);  // the others may still be on their way out
}

// A dead server leaves its socket behind.
TEST_F(PrivateServerTest, AKilledServerIsReplacedAndItsJobsAreThere) {
  ASSERT_EQ(RunProgram(Client(kRun)).exit_code, 0);
  for (const int pid : Servers()) kill(pid, SIGKILL);
  EXPECT_TRUE(fs::exists(State("server.socket")));
  const ProcessResult list = RunProgram(Client({"list", "--format", "json"}));
  ASSERT_EQ(list.exit_code, 0) << list.err;
  EXPECT_EQ(At(ParseJson(list.out), "jobs", 0, "state").string_value(), "SUCCEEDED");
}

// The watch starts the server again; what it had finished counts.
TEST_F(PrivateServerTest, AKilledServerIsRevivedByTheClientThatWatches) {
  Process run(Client({"run", "equilibrium", "--rho", "0.53", "--delta", "0.2,0.1", "--collisions",
                      "300000", "--verify", "--progress", "json", "--format", "json"}));
  const std::string line = run.WaitForErrLine([](const std::string& text) {
    return At(ParseJson(text), "progress", "samples").number_value() > 0;
  });
  ASSERT_NE(line, "");
  for (const int pid : Servers()) kill(pid, SIGKILL);
  const ProcessResult result = run.Wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(At(ParseJson(result.out), "points").list_value().values_size(), 2);
}

TEST_F(PrivateServerTest, AServerThatCannotStartIsExplained) {
  ProcessOptions options = Client({"list"});
  options.environment["BALLPISTON_SERVER_PROGRAM"] = "/bin/false";
  const ProcessResult result = RunProgram(options);
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("/bin/false ended at once with exit status 1"));
  EXPECT_THAT(result.err, HasSubstr(State("server.log")));
}

TEST_F(PrivateServerTest, ALongHomeIsNoObstacle) {
  ProcessOptions options = Client(kRun);
  options.environment["HOME"] = home_.File(std::string(120, 'x'));
  options.environment["TMPDIR"] = home_.path();
  const ProcessResult result = RunProgram(options);
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(PrivateServerTest, StatusLooksAtTheServerThatRunsAndStartsNone) {
  const ProcessResult none = RunProgram(Client({"status"}));
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, HasSubstr("no private server is running"));
  EXPECT_TRUE(Servers().empty());
  EXPECT_FALSE(fs::exists(State("server.log")));

  ASSERT_EQ(RunProgram(Client(kRun)).exit_code, 0);
  const ProcessResult one = RunProgram(Client({"status", "--format", "json"}));
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(At(ParseJson(one.out), "stored_jobs").number_value(), 1);
}

}  // namespace
}  // namespace ballpiston
