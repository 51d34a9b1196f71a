// What an operator does with a store, and with the limits of a server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> kQuestion = {"run",      "equilibrium", "--rho",        "0.53",
                                            "--delta",  "0.2",         "--collisions", "2000",
                                            "--verify", "--format",    "json",         "--fresh"};

ProcessResult Server(const TestServer& server, std::vector<std::string> flags) {
  flags.insert(flags.begin(), {"--data-dir", server.DataDir()});
  return RunProgram(ServerCommand(server.folder(), std::move(flags)));
}

TEST(StoreCommands, AStoreIsCheckedCopiedAndRestored) {
  TestServer server;
  const ProcessResult before = server.Client(kQuestion);
  ASSERT_EQ(before.exit_code, 0) << before.err;
  const std::string backup = server.folder().Path("backup");
  const ProcessResult checked = Server(server, {"--check"});  // while it runs
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("1"));
  const ProcessResult copied = Server(server, {"--backup", backup});
  EXPECT_EQ(copied.exit_code, 0) << copied.err;
  EXPECT_NE(Server(server, {"--backup", backup}).exit_code, 0);  // it is there already

  server.Stop();
  std::filesystem::remove_all(server.DataDir());
  std::filesystem::create_directory(server.DataDir());
  std::filesystem::copy_file(backup, server.DataDir() + "/store.sqlite3");
  server.Start();
  const std::string name = At(ParseJson(before.out), "job", "name").string_value();
  const ProcessResult after = server.Client({"result", name, "--format", "json"});
  EXPECT_EQ(PointsOf(after.out), PointsOf(before.out));
}

TEST(StoreCommands, WhatIsNoStoreIsToldWithExitCode2) {
  TestServer server;
  server.Stop();
  std::ofstream(server.DataDir() + "/store.sqlite3") << "no store at all";
  for (const std::string flag : {"--check", "--backup=copy"}) {
    const ProcessResult result = Server(server, {flag});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("store.sqlite3"));
    EXPECT_EQ(result.out, "");
  }
}

TEST(StoreCommands, OneIsDoneAtATime) {
  const TemporaryFolder home;
  const std::string access = home.Path("access");
  const ProcessResult result =
      RunProgram(ServerCommand(home, {"--data-dir", home.Path("data"), "--check", "--backup=x",
                                      "--access-file", access, "--new-token=a:submit"}));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--check and --backup and --new-token exclude each other"));
  EXPECT_EQ(result.out, "");
  EXPECT_FALSE(std::filesystem::exists(access));
}

TEST(Limits, AreFlagsAndNameThemselves) {
  const TemporaryFolder home;
  const std::string address = "unix:" + home.Path("socket");
  Process server(ServerCommand(home, {"--listen", address, "--data-dir", home.Path("data"),
                                      "--max-points-per-job=2", "--max-message-bytes=2048"}));
  ASSERT_TRUE(server.WaitForErr("listening on"));
  const auto ask = [&](const std::string& deltas) {
    ProcessOptions options;
    options.command = {BALLPISTON_CLIENT_BINARY,
                       "submit",
                       "equilibrium",
                       "--rho",
                       "0.53",
                       "--delta",
                       deltas,
                       "--server",
                       address};
    options.environment = CleanEnvironment(home);
    return RunProgram(options);
  };
  EXPECT_EQ(ask("0.1,0.2").exit_code, 0);
  const ProcessResult points = ask("0.1,0.15,0.2");
  EXPECT_NE(points.exit_code, 0);
  EXPECT_THAT(points.err, HasSubstr("--max-points-per-job"));
  EXPECT_THAT(ask("0.1:0.2:1000").err, HasSubstr("2048"));  // gRPC's words
}

TEST(Limits, AreNotNegative) {
  const TemporaryFolder home;
  for (const std::string flag : {"--max-active-jobs=-1", "--max-samples-per-job=-2",
                                 "--max-message-bytes=0", "--max-streams=-1"}) {
    const ProcessResult result =
        RunProgram(ServerCommand(home, {"--data-dir", home.Path("data"), flag}));
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr(flag + " is out of range"));
  }
}

}  // namespace
}  // namespace ballpiston
