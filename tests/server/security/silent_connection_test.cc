// Connections at whose other end nobody is any more.
#include <chrono>
#include <string>

#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/http_get.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using std::chrono::milliseconds;

// One of these is short; the others are longer than any test may take.
ServerOptions Options(const TemporaryFolder& folder, const ConnectionTiming& timing) {
  ServerOptions options;
  options.data_dir = folder.path();
  options.listen = "127.0.0.1:0";
  options.factory = FakeExperiments();
  options.connections = timing;
  return options;
}

constexpr std::chrono::hours kNever(1);

TEST(SilentConnection, OneThatNeverSpeaksIsClosed) {
  TemporaryFolder folder;
  RunningServer server(Options(folder, {.handshake = milliseconds(200), .ping_interval = kNever}));
  Connection connection(server.server().address());
  connection.ReadToTheEnd();  // has one
}

TEST(SilentConnection, OneThatAnswersNoPingIsClosed) {
  TemporaryFolder folder;
  RunningServer server(Options(folder, {.handshake = kNever,
                                        .ping_interval = milliseconds(100),
                                        .ping_timeout = milliseconds(100)}));
  Connection connection(server.server().address());
  const std::string empty_settings("\0\0\0\x4\0\0\0\0\0", 9);
  connection.Send("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + empty_settings);
  EXPECT_NE(connection.ReadToTheEnd(), "");
}

}  // namespace
}  // namespace ballpiston::server
