// What a server tells of itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <string>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;

TEST(Status, TellsWhatWasAskedAndComputed) {
  const TestServer server(2);
  ASSERT_EQ(server
                .Client({"run", "equilibrium", "--rho", "0.53", "--delta", "0.2", "--collisions",
                         "5000", "--verify", "--format", "json"})
                .exit_code,
            0);
  const ProcessResult table = server.Client({"status"});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("state     serving\n"));
  EXPECT_THAT(table.out, HasSubstr("workers   0 of 2 busy\n"));
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
      home, {"--listen", "unix:" + home.Path("socket"), "--data_dir", home.Path("data"),
             "--log_format", "json", "--metrics_listen", "127.0.0.1:0"}));
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

TEST(Status, MetricsForOtherMachinesAreRefused) {
  const TemporaryFolder home;
  const ProcessResult result = RunProgram(
      ServerCommand(home, {"--data_dir", home.Path("data"), "--metrics_listen", "0.0.0.0:9090"}));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--metrics_listen=0.0.0.0:9090 is not a loopback address"));
}

}  // namespace
}  // namespace ballpiston
