#include "server/listen_address.h"

#include <fstream>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;

TEST(ListenAddress, LoopbackAndUnixSocketsAreAccepted) {
  for (const char* text : {"127.0.0.1:0", "127.8.9.10:65535", "[::1]:50051", "localhost:50051",
                           "unix:/tmp/x.socket", "unix:relative"}) {
    const auto address = ParseListenAddress(text);
    ASSERT_TRUE(address.ok()) << address.status();
    EXPECT_EQ(address->Text(), text);
  }
}

TEST(ListenAddress, AddressesOtherMachinesReachAreRefused) {
  for (const char* text : {"0.0.0.0:50051", "[::]:50051", "192.168.1.1:50051", "example.org:50051",
                           "128.0.0.1:1", "[2001:db8::1]:1", "[::ffff:127.0.0.1]:1"}) {
    const auto address = ParseListenAddress(text);
    EXPECT_TRUE(absl::IsInvalidArgument(address.status())) << text;
    EXPECT_THAT(std::string(address.status().message()), HasSubstr("loopback"));
  }
}

TEST(ListenAddress, NonsenseIsRefusedWithTheFlagAndTheValue) {
  for (const char* text :
       {"", "50051", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1", "127.0.0.1:http",
        "::1:50051", "unix:", ":50051", "unix-abstract:x"}) {
    const auto address = ParseListenAddress(text);
    EXPECT_TRUE(absl::IsInvalidArgument(address.status())) << text;
    EXPECT_THAT(std::string(address.status().message()),
                HasSubstr(std::string("--listen=") + text));
  }
}

TEST(ListenAddress, ASocketPathThatIsTooLongIsRefused) {
  const auto address = ParseListenAddress("unix:/" + std::string(107, 'x'));
  EXPECT_THAT(std::string(address.status().message()), HasSubstr("108 bytes"));
  EXPECT_TRUE(ParseListenAddress("unix:/" + std::string(106, 'x')).ok());
}

TEST(ListenAddress, AFileThatIsNoSocketStays) {
  TemporaryFolder folder;
  std::ofstream(folder.File("precious")) << "x";
  const auto address = ParseListenAddress("unix:" + folder.File("precious"));
  EXPECT_TRUE(absl::IsFailedPrecondition(ClearSocketPath(*address)));
  EXPECT_TRUE(std::filesystem::exists(folder.File("precious")));
}

}  // namespace
}  // namespace ballpiston::server
