#include "client/library/server_address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;

TEST(ServerAddress, IsHostAndPortOrASocket) {
  EXPECT_EQ(*GrpcTarget("localhost:50051"), "dns:///localhost:50051");
  EXPECT_EQ(*GrpcTarget("10.0.0.7:1"), "dns:///10.0.0.7:1");
  EXPECT_EQ(*GrpcTarget("[::1]:65535"), "dns:///[::1]:65535");
  EXPECT_EQ(*GrpcTarget("unix:/run/ballpiston.socket"), "unix:/run/ballpiston.socket");
  EXPECT_EQ(*GrpcTarget("unix:relative"), "unix:relative");
}

TEST(ServerAddress, RefusesAnythingElse) {
  const std::string long_path(kMaxSocketPath + 1, 'x');
  for (const std::string& text :
       {std::string(), std::string("localhost"), std::string(":50051"), std::string("localhost:"),
        std::string("localhost:0"), std::string("localhost:65536"), std::string("localhost:x"),
        std::string("http://localhost:1"), std::string("::1:50051"), std::string("[]:1"),
        std::string("a b:1"), std::string("unix:"), "unix:" + long_path}) {
    const auto target = GrpcTarget(text);
    EXPECT_EQ(target.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(std::string(target.status().message()), HasSubstr("host:port or unix:PATH"));
  }
}

}  // namespace
}  // namespace ballpiston::client
