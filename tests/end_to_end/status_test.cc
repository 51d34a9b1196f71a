// What a server tells of itself.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;

constexpr char kIdle[] = "workers   0 of 2 busy\n";

// A worker that has handed in its last block, so that the job has ended, is busy for a moment more.
ProcessResult StatusOfIdle(const TestServer& server) {
  ProcessResult table;
  for (int attempt = 0; attempt < 100; ++attempt) {
    table = server.Client({"status"});
    if (table.exit_code != 0 || table.out.find(kIdle) != std::string::npos) break;
  }
  return table;
}

TEST(Status, TellsWhatWasAskedAndComputed) {
  const TestServer server(2);
  ASSERT_EQ(server
                .Client({"run", "equilibrium", "--rho", "0.53", "--delta", "0.2", "--collisions",
                         "5000", "--verify", "--format", "json"})
                .exit_code,
            0);
  const ProcessResult table = StatusOfIdle(server);
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("state     serving\n"));
  EXPECT_THAT(table.out, HasSubstr(kIdle));
  EXPECT_THAT(table.out, HasSubstr("0 queued, 0 running, 1 in the store\n"));
  EXPECT_THAT(table.out, HasSubstr("wall hits/s"));
  EXPECT_EQ(table.err, "");

  const auto json = ParseJson(server.Client({"status", "--format", "json"}).out);
  EXPECT_EQ(At(json, "state").string_value(), "SERVING");
  EXPECT_GE(At(json, "samples_computed").number_value(), 5000);
  EXPECT_GT(At(json, "rates", "wall_hit").number_value(), 0);
  EXPECT_EQ(At(json, "principal").string_value(), "local");
}

TEST(Status, LogLinesAreJsonWhereThatIsWanted) {
  const TemporaryFolder home;
  Process server(ServerCommand(
      home, {"--listen", "unix:" + home.Path("socket"), "--data-dir", home.Path("data"),
             "--log-format", "json", "--metrics-listen", "127.0.0.1:0"}));
  ASSERT_TRUE(server.WaitForErr("listening on"));
  server.Signal(SIGTERM);
  const ProcessResult result = server.Wait();
  EXPECT_EQ(result.exit_code, 0);
  size_t begin = 0;
  for (size_t end; (end = result.err.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const auto line = ParseJson(result.err.substr(begin, end - begin));
    EXPECT_EQ(At(line, "severity").string_value(), "INFO");
    EXPECT_NE(At(line, "message").string_value(), "");
  }
  EXPECT_EQ(begin, result.err.size());
  EXPECT_THAT(result.err, HasSubstr("metrics at http://127.0.0.1:"));
}

// As if whoever reads the log had stopped to.
class FullPipe {
 public:
  explicit FullPipe(const std::string& path) {
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
    descriptor_ = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    const std::string block(4096, 'x');
    while (write(descriptor_, block.data(), block.size()) > 0) continue;
  }
  ~FullPipe() { close(descriptor_); }

 private:
  int descriptor_ = -1;
};

TEST(Status, ALogThatNobodyReadsStopsNothing) {
  const TemporaryFolder home;
  const FullPipe log(home.Path("log"));
  const std::string address = "unix:" + home.Path("socket");
  ProcessOptions command = ServerCommand(
      home, {"--listen", address, "--data-dir", home.Path("data"), "--drain-seconds", "1"});
  command.command.insert(command.command.begin(),
                         {"/bin/sh", "-c", "exec \"$@\" 2>\"$0\"", home.Path("log")});
  Process server(command);
  const ProcessOptions status = {
      {BALLPISTON_CLIENT_BINARY, "status", "--server", address}, CleanEnvironment(home), ""};
  while (RunProgram(status).exit_code != 0) continue;  // until it has begun
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(RunProgram({{BALLPISTON_CLIENT_BINARY, "run", "equilibrium", "--rho", "0.53",
                           "--delta", "0.2", "--collisions", "100", "--server", address},
                          CleanEnvironment(home),
                          ""})
                  .exit_code,
              0);
  }
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait().exit_code, 0);
}

TEST(Status, MetricsForOtherMachinesAreRefused) {
  const TemporaryFolder home;
  const ProcessResult result = RunProgram(
      ServerCommand(home, {"--data-dir", home.Path("data"), "--metrics-listen", "0.0.0.0:9090"}));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--metrics-listen=0.0.0.0:9090 is not a loopback address"));
}

}  // namespace
}  // namespace ballpiston
