// Commands for a store, and limits of a server, as an operator uses them.

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

// Beside the server, with its data folder.
ProcessResult RunBeside(const TestServer& server, const Words& flags) {
  return RunServer(server.folder(), Joined({{"--data_dir", server.data_dir()}, flags}));
}

TEST(StoreCommands, AStoreIsCheckedCopiedAndRestored) {
  TestServer server;
  const ProcessResult before = server.Client(Split(
      "run equilibrium --rho 0.53 --delta 0.2 --collisions 2000 --verify --format json --fresh"));
  ASSERT_THAT(before, ExitsWith(0));
  const std::string backup = server.folder().File("backup");
  const ProcessResult checked = RunBeside(server, {"--check"});  // while it runs
  EXPECT_THAT(checked, ExitsWith(0));
  EXPECT_THAT(checked.out, HasSubstr("1"));
  const ProcessResult copied = RunBeside(server, {"--backup", backup});
  EXPECT_THAT(copied, ExitsWith(0));
  EXPECT_NE(RunBeside(server, {"--backup", backup}).exit_code, 0);  // the file exists

  server.Stop();
  std::filesystem::remove_all(server.data_dir());
  std::filesystem::create_directory(server.data_dir());
  std::filesystem::copy_file(backup, server.data_dir() + "/store.sqlite3");
  server.Start();
  const std::string name = At(ParseJson(before.out), "job", "name").string_value();
  const ProcessResult after = server.Client({"result", name, "--format", "json"});
  EXPECT_EQ(PointsOf(after.out), PointsOf(before.out));
}

TEST(StoreCommands, AFileOfAnotherFormatIsRejectedWithExitCodeTwo) {
  TestServer server;
  server.Stop();
  WriteFile(server.data_dir() + "/store.sqlite3", "no store at all");
  for (const std::string flag : {"--check", "--backup=copy"}) {
    const ProcessResult result = RunBeside(server, {flag});
    EXPECT_THAT(result, ExitsWith(2));
    EXPECT_THAT(result.err, HasSubstr("store.sqlite3"));
    EXPECT_EQ(result.out, "");
  }
}

TEST(Limits, ErrorsNameTheFlagOfTheLimit) {
  const TestServer server({.flags = {"--max-points-per-job=2", "--max-message-bytes=2048"}});
  const auto ask = [&](const std::string& deltas) {
    return server.Client({"submit", "equilibrium", "--rho", "0.53", "--delta", deltas});
  };
  EXPECT_THAT(ask("0.1,0.2"), ExitsWith(0));
  const ProcessResult points = ask("0.1,0.15,0.2");
  EXPECT_NE(points.exit_code, 0);
  EXPECT_THAT(points.err, HasSubstr("--max-points-per-job"));
  EXPECT_THAT(ask("0.1:0.2:1000").err, HasSubstr("2048"));  // gRPC's words
}

}  // namespace
}  // namespace ballpiston
