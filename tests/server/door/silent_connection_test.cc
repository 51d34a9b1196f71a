// Connections whose client no longer answers.
#include <chrono>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/http_get.h"
#include "tests/server/running_server.h"
#include "tests/support/await.h"

namespace ballpiston::server {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

// Part of the GOAWAY frame of HTTP/2: its type, no flags, stream 0.
const std::string kGoAway("\x7\0\0\0\0\0", 6);

// In each test one time limit is short, and the others are not reached.
TestServerOptions OnPort(const ConnectionTiming& timing) {
  return {.listen = "127.0.0.1:0", .connections = timing};
}

TEST(SilentConnection, AConnectionWithoutAHandshakeIsClosed) {
  RunningServer server(OnPort({.handshake = milliseconds(200), .ping_interval = kNever}));
  Connection connection(server.address());
  EXPECT_THAT(connection.ReadToTheEnd(), HasSubstr(kGoAway));
}

TEST(SilentConnection, AConnectionThatAnswersNoPingIsClosed) {
  RunningServer server(OnPort({.handshake = kNever,
                               .ping_interval = milliseconds(100),
                               .ping_timeout = milliseconds(100)}));
  Connection connection(server.address());
  const std::string empty_settings("\0\0\0\x4\0\0\0\0\0", 9);
  connection.Send("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + empty_settings);
  EXPECT_THAT(connection.ReadToTheEnd(), HasSubstr(std::string("\0\0\x8\x6", 4)));  // the ping
}

}  // namespace
}  // namespace ballpiston::server
