#include "client/library/server_address.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

TEST(ServerAddress, IsHostAndPortOrASocket) {
  EXPECT_THAT(GrpcTarget("localhost:50051"), IsOkAndHolds("dns:///localhost:50051"));
  EXPECT_THAT(GrpcTarget("10.0.0.7:1"), IsOkAndHolds("dns:///10.0.0.7:1"));
  EXPECT_THAT(GrpcTarget("[::1]:65535"), IsOkAndHolds("dns:///[::1]:65535"));
  EXPECT_THAT(GrpcTarget("unix:/run/a.socket"), IsOkAndHolds("unix:/run/a.socket"));
  EXPECT_THAT(GrpcTarget("unix:relative"), IsOkAndHolds("unix:relative"));
}

TEST(ServerAddress, RejectsAnythingElse) {
  const std::string long_socket = "unix:" + std::string(kMaxSocketPath + 1, 'x');
  for (const std::string text :
       {"", "localhost", ":50051", "localhost:", "localhost:0", "localhost:65536", "localhost:x",
        "http://localhost:1", "::1:50051", "[]:1", "a b:1", "unix:", long_socket.c_str()}) {
    EXPECT_THAT(GrpcTarget(text),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("host:port or unix:PATH")))
        << text;
  }
}

// The server takes the same spellings.
TEST(ServerAddress, TheLoopbackHasManySpellings) {
  for (const char* text : {"127.0.0.1:1", "127.3.2.1:1", "[::1]:1", "[0:0:0:0:0:0:0:1]:1",
                           "[0::0001]:1", "[::0.0.0.1]:1"}) {
    EXPECT_TRUE(IsLoopback(text)) << text;
  }
  for (const char* text : {"128.0.0.1:1", "[::2]:1", "[::]:1", "::1:1", "[::1:1", "[127.0.0.1]:1",
                           "[::1%lo]:1", "localhost.example:1", "unix:/127.0.0.1"}) {
    EXPECT_FALSE(IsLoopback(text)) << text;
  }
}

}  // namespace
}  // namespace ballpiston::client
