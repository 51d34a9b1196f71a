// The log of a server.
#include <fcntl.h>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

TEST(ServerLog, NamesTheAddressOfTheMetrics) {
  TestServer server({.flags = {"--metrics-listen", "127.0.0.1:0"}});
  EXPECT_EQ(server.Stop(), 0);
  EXPECT_THAT(server.log(), HasSubstr("metrics at http://127.0.0.1:"));
}

// A full pipe without a reader.
class FullPipe {
 public:
  explicit FullPipe(const std::string& path) {
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
    descriptor_ = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    const std::string block(4096, 'x');
    while (write(descriptor_, block.data(), block.size()) > 0) continue;
  }
  ~FullPipe() { close(descriptor_); }

  // Empties the pipe.
  std::string Read() const {
    std::string text;
    std::string block(4096, 0);
    for (ssize_t n = 0; (n = read(descriptor_, block.data(), block.size())) > 0;) {
      text.append(block, 0, static_cast<size_t>(n));
    }
    return text;
  }

 private:
  int descriptor_ = -1;
};

TEST(ServerLog, TheServerGoesOnWhenNobodyReadsItsLog) {
  const TemporaryFolder home;
  const FullPipe log(home.File("log"));
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
  log.Read();
  EXPECT_EQ(server.Stop(), 0);
  EXPECT_THAT(log.Read(), HasSubstr("warning: lines were dropped: the log was not read (lines="));
}

}  // namespace
}  // namespace ballpiston
