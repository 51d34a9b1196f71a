// Two servers that want the same thing: the second one says so and ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;

ProcessResult SecondServer(const TemporaryFolder& home, const std::vector<std::string>& flags) {
  return RunProgram(ServerCommand(home, flags));
}

TEST(TwoServers, DoNotShareADataFolder) {
  const TestServer first;
  const TemporaryFolder home;
  const ProcessResult second = SecondServer(
      home, {"--listen", "unix:" + home.Path("socket"), "--data-dir", first.DataDir()});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr(first.DataDir()));
  EXPECT_EQ(first.Client({"list"}).exit_code, 0);  // unharmed
}

TEST(TwoServers, DoNotShareASocket) {
  const TestServer first;
  const TemporaryFolder home;
  const ProcessResult second =
      SecondServer(home, {"--listen", first.Address(), "--data-dir", home.Path("data")});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_EQ(first.Client({"list"}).exit_code, 0);
}

TEST(TwoServers, DoNotShareAPort) {
  const TemporaryFolder home;
  Process first(ServerCommand(home, {"--listen", "127.0.0.1:0", "--data-dir", home.Path("first")}));
  const std::string line = first.WaitForErrLine(
      [](const std::string& text) { return text.find("listening on") != std::string::npos; });
  const std::string address = line.substr(line.find("127.0.0.1:"));
  const ProcessResult second =
      SecondServer(home, {"--listen", address, "--data-dir", home.Path("second")});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr(address));
  const ProcessResult list =
      RunProgram({.command = {BALLPISTON_CLIENT_BINARY, "list", "--server", address},
                  .environment = CleanEnvironment(home),
                  .input = ""});
  EXPECT_EQ(list.exit_code, 0) << list.err;
}

TEST(Server, NeedsADataFolderItCanWriteTo) {
  const TemporaryFolder home;
  std::ofstream(home.Path("file")) << "not a folder";
  const ProcessResult result = SecondServer(
      home, {"--listen", "unix:" + home.Path("socket"), "--data-dir", home.Path("file/data")});
  EXPECT_EQ(result.exit_code, 6);
  EXPECT_THAT(result.err, HasSubstr("data folder " + home.Path("file")));
  EXPECT_THAT(result.err, HasSubstr("is not writable"));
}

}  // namespace
}  // namespace ballpiston
