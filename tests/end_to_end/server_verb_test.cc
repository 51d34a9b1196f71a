// `ballpiston server`: starts, finds, checks and stops servers of this machine.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

class ServerVerbTest : public ::testing::Test {
 protected:
  ~ServerVerbTest() override {
    for (const Words& server : {private_, named_}) Server("stop", server);
  }

  // A server that a failing test leaves behind ends by itself.
  ProcessResult Start(const Words& flags) const {
    return Server("start", Joined({flags, {"--", "--idle-exit-seconds", "1000"}}));
  }
  ProcessResult Server(const std::string& verb, const Words& flags) const {
    return RunProgram(ClientCommand(home_, Joined({{"server", verb}, flags})));
  }
  ProcessResult Client(const std::string& words) const {
    return RunProgram(ClientCommand(home_, Split(words)));
  }

  const TemporaryFolder home_;
  const Words private_ = {};
  const Words named_ = {"--data-dir", home_.File("data")};
};

TEST_F(ServerVerbTest, StartsAndStopsTheServerOfTheClients) {
  EXPECT_THAT(Server("stop", private_), ExitsWith(3));
  const ProcessResult started = Start(private_);
  EXPECT_THAT(started, ExitsWith(0));
  EXPECT_THAT(started.out, StartsWith("unix:"));
  const ProcessResult again = Server("start", private_);
  EXPECT_EQ(again.out, started.out);
  EXPECT_THAT(again.err, HasSubstr("already runs there"));
  EXPECT_THAT(Start(private_), ExitsWith(4));  // flags that would have no effect
  EXPECT_THAT(Client("server status"), ExitsWith(0));
  EXPECT_THAT(Server("stop", private_), ExitsWith(0));
  EXPECT_THAT(Client("server status"), ExitsWith(3));
}

TEST_F(ServerVerbTest, StartsAServerInAFolderWithFlags) {
  Words flags = named_;
  flags.insert(flags.end(), {"--workers", "1", "--listen", "127.0.0.1:0"});
  const ProcessResult started = Start(flags);
  EXPECT_THAT(started, ExitsWith(0));
  EXPECT_THAT(started.out, StartsWith("127.0.0.1:"));
  const std::string address = started.out.substr(0, started.out.find('\n'));
  const ProcessResult status = Client("server status --server " + address);
  EXPECT_THAT(status.out, HasSubstr("0 of 1 busy"));
  EXPECT_THAT(Server("check", named_).out, HasSubstr("sound"));
  const std::string copy = home_.File("copy");
  EXPECT_THAT(Server("backup", Joined({{copy}, named_})), ExitsWith(0));
  EXPECT_TRUE(fs::exists(copy));
  EXPECT_THAT(Server("stop", named_), ExitsWith(0));
}

// The lock file of a folder that another machine uses holds the number of a process of that
// machine.
TEST_F(ServerVerbTest, StopIgnoresProcessesThatDoNotUseTheFolder) {
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

TEST_F(ServerVerbTest, MakesATokenForTheAccessFile) {
  const std::string access = home_.File("access");
  const ProcessResult made = Server("token", {"ada:submit:9", "--access-file", access});
  EXPECT_THAT(made, ExitsWith(0));
  EXPECT_GT(made.out.size(), 20u);
  EXPECT_THAT(Contents(access), HasSubstr(" ada submit "));
  EXPECT_THAT(Server("token", {"ada", "--access-file", access}), ExitsWith(2));
  EXPECT_THAT(Server("token", {"ada:submit"}), ExitsWith(2));
}

}  // namespace
}  // namespace ballpiston
