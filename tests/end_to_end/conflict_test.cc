// A second server with the folder or the address of the first one prints an error and exits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;

TEST(TwoServers, DoNotShareADataFolder) {
  const TestServer first;
  const TemporaryFolder home;
  const ProcessResult second =
      RunServer(home, {"--listen", "unix:" + home.File("socket"), "--data_dir", first.data_dir()});
  EXPECT_THAT(second, ExitsWith(2));
  EXPECT_THAT(second.err, HasSubstr(first.data_dir()));
  EXPECT_THAT(first.Client({"list"}), ExitsWith(0));  // the first server still answers
}

TEST(TwoServers, DoNotShareASocket) {
  const TestServer first;
  const TemporaryFolder home;
  const ProcessResult second =
      RunServer(home, {"--listen", first.address(), "--data_dir", home.File("data")});
  EXPECT_THAT(second, ExitsWith(2));
  EXPECT_THAT(first.Client({"list"}), ExitsWith(0));
}

TEST(TwoServers, DoNotShareAPort) {
  const TestServer first({.listen = "127.0.0.1:0"});
  const TemporaryFolder home;
  const ProcessResult second =
      RunServer(home, {"--listen", first.address(), "--data_dir", home.File("data")});
  EXPECT_THAT(second, ExitsWith(2));
  EXPECT_THAT(second.err, HasSubstr(first.address()));
  EXPECT_THAT(first.Client({"list"}), ExitsWith(0));
}

TEST(Server, NeedsADataFolderItCanWriteTo) {
  const TemporaryFolder home;
  WriteFile(home.File("file"), "not a folder");
  const ProcessResult result = RunServer(
      home, {"--listen", "unix:" + home.File("socket"), "--data_dir", home.File("file/data")});
  EXPECT_THAT(result, ExitsWith(6));
  EXPECT_THAT(result.err, HasSubstr("data folder " + home.File("file")));
  EXPECT_THAT(result.err, HasSubstr("is not writable"));
}

}  // namespace
}  // namespace ballpiston
