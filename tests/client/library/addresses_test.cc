// Addresses of servers, and the security of connections to them.
#include <climits>

#include "client/library/channel_security.h"
#include "client/library/server_address.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// ---- server_address.h ----

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
        "http://localhost:1", "::1:50051", "[]:1", "a b:1", "unix:", "unix:a#b", "unix:a?b",
        "unix:a,b", "unix:a%20b", long_socket.c_str()}) {
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

// ---- channel_security.h ----

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
constexpr auto kDenied = absl::StatusCode::kPermissionDenied;

constexpr char kSecret[] = "hunter2hunter2";

TEST(ChannelSecurity, ATokenIsSentInTheClearToALoopbackAddressOnly) {
  for (const char* address : {"example.org:1", "192.168.0.7:1", "[::2]:1", "127.example.org:1"}) {
    EXPECT_THAT(CheckSecurity({.token = kSecret}, address),
                StatusIs(kInvalid, AllOf(HasSubstr("use TLS"), Not(HasSubstr(kSecret)))));
    EXPECT_THAT(CheckSecurity({.token_file = "f"}, address), StatusIs(kInvalid));
    EXPECT_OK(CheckSecurity({.tls = true, .token = kSecret}, address));
    EXPECT_OK(CheckSecurity({.ca = "f", .token_file = "f"}, address));
    EXPECT_OK(CheckSecurity({}, address));
  }
  for (const char* address : {"127.0.0.1:1", "127.3.2.1:1", "[::1]:1"}) {
    EXPECT_OK(CheckSecurity({.token = kSecret}, address));
  }
  EXPECT_EQ(LiteralAddress("localhost:1"), "127.0.0.1:1");
}

// A server makes another token at each start. Machines may share the home folder.
TEST(ChannelSecurity, TheOwnTokenIsThatOfTheAddressOnThisMachine) {
  char machine[HOST_NAME_MAX + 1] = {};
  ASSERT_EQ(gethostname(machine, HOST_NAME_MAX), 0);
  const TemporaryFolder state;
  const ScopedVariable variable("XDG_STATE_HOME", state.path());
  const std::string tokens = state.File("ballpiston/tokens/");
  for (const std::string& folder : {std::string(), std::string(machine), std::string("other")}) {
    std::filesystem::create_directories(tokens + folder);
    WriteFile(tokens + folder + "/127.0.0.1:2", "of another machine\n");
  }
  std::filesystem::remove(tokens + machine + "/127.0.0.1:2");
  for (const char* token : {"first", "second"}) {
    WriteFile(tokens + machine + "/127.0.0.1:1", std::string(token) + "\n");
    EXPECT_EQ(OwnToken("127.0.0.1:1"), token);
  }
  EXPECT_EQ(OwnToken("127.0.0.1:2"), "");
}

class SecurityFiles : public ::testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text, mode_t mode = 0600) {
    const std::string path = folder_.File(name);
    WriteFile(path, text);
    chmod(path.c_str(), mode);
    return path;
  }
  // The error does not show the secret.
  absl::Status Check(const ChannelSecurity& security) {
    absl::Status status = CredentialsOf(security, "host:1").status();
    EXPECT_THAT(std::string(status.message()), Not(HasSubstr(kSecret)));
    return status;
  }
  absl::Status WithToken(const std::string& text, mode_t mode = 0600) {
    return Check({.tls = true, .token_file = Write("token", text, mode)});
  }

  const TemporaryFolder folder_;
};

TEST_F(SecurityFiles, ATokenFileHoldsOneWord) {
  EXPECT_OK(WithToken(kSecret));
  EXPECT_OK(WithToken(std::string(kSecret) + "\r\n"));
  for (const std::string& text :
       {std::string(), std::string("\n"), std::string("two ") + kSecret,
        std::string(kSecret) + "\nnext", std::string(kSecret) + "\x01", std::string(257, 'x')}) {
    EXPECT_THAT(WithToken(text), StatusIs(kInvalid)) << text;
  }
}

TEST_F(SecurityFiles, ATokenFileThatOthersCanReadIsRejected) {
  for (const mode_t mode : {0640u, 0604u, 0644u, 0660u, 0666u}) {
    EXPECT_THAT(WithToken(kSecret, mode), StatusIs(kDenied, HasSubstr("chmod 600")));
  }
}

TEST_F(SecurityFiles, ErrorsNameTheFileAndTheFault) {
  EXPECT_THAT(Check({.ca = folder_.path()}).message(), HasSubstr("cannot be read"));
  EXPECT_THAT(Check({.ca = Write("ca", kSecret)}).message(), HasSubstr("a PEM file is needed"));
}

}  // namespace
}  // namespace ballpiston::client
