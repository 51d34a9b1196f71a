#include "server/door/listen_address.h"

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

TEST(ListenAddress, AddressesNamesAndUnixSocketsAreParsed) {
  for (const char* text : {"127.0.0.1:0", "[::1]:65535", "0.0.0.0:50051", "[2001:db8::1]:1",
                           "node-7.lab.example.org:50051", "unix:/tmp/x.socket", "unix:relative"}) {
    ASSERT_OK_AND_ASSIGN(const auto address, ParseListenAddress(text));
    EXPECT_EQ(address.Text(), text);
  }
  EXPECT_EQ(ParseListenAddress("localhost:1")->Text(), "127.0.0.1:1");
}

TEST(ListenAddress, OnlyLoopbackIsLoopback) {
  for (const char* text : {"127.0.0.1:1", "[::1]:1", "localhost:1"}) {
    EXPECT_TRUE(ParseListenAddress(text)->IsLoopback()) << text;
  }
  for (const char* text :
       {"0.0.0.0:1", "[::]:1", "192.168.1.1:1", "127.1:1", "127.0.0.2:1", "[::ffff:127.0.0.1]:1",
        "[::1%lo]:1", "localhost.example.org:1", "LOCALHOST:1", "[::1]%lo]:1"}) {
    EXPECT_FALSE(ParseListenAddress(text)->IsLoopback()) << text;
  }
}

TEST(ListenAddress, ErrorsShowTheFlagAndTheValue) {
  for (const char* text :
       {"", "50051", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1", "127.0.0.1:http",
        "::1:50051", "unix:", ":50051", "unix-abstract:x:y", "ipv4:127.0.0.1:1",
        "dns:///localhost:1", "[]:1", "[::1:1", "[::1]%lo:1", " localhost:1", "a/b:1"}) {
    const auto address = ParseListenAddress(text);
    EXPECT_THAT(address, StatusIs(absl::StatusCode::kInvalidArgument,
                                  HasSubstr(std::string("--listen=") + text)))
        << text;
  }
}

TEST(ListenAddress, ASocketPathThatGrpcCannotUseIsRefused) {
  for (const std::string text : {"unix:a#b", "unix:a?b", "unix:a,b", "unix:a%20b"}) {
    EXPECT_THAT(ParseListenAddress(text), StatusIs(absl::StatusCode::kInvalidArgument,
                                                   HasSubstr(text + ": gRPC cannot use")));
  }
  const auto address = ParseListenAddress("unix:/" + std::string(107, 'x'));
  EXPECT_THAT(std::string(address.status().message()), HasSubstr("108 bytes"));
  EXPECT_OK(ParseListenAddress("unix:/" + std::string(106, 'x')));
}

}  // namespace
}  // namespace ballpiston::server
