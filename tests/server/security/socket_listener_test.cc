#include "server/security/socket_listener.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <future>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "grpcpp/create_channel.h"
#include "gtest/gtest.h"
#include "server/security/peer_user.h"
#include "tests/server/call_by_name.h"
#include "tests/support/running_server.h"
#include "tests/server/secure_server.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr uid_t kStranger = 65534;

int Connect(const std::string& path) {
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  if (connect(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0) {
    return descriptor;
  }
  close(descriptor);
  return -1;
}

// Whether the other side closes without a word.
bool IsClosed(int descriptor) {
  char byte;
  const bool closed = read(descriptor, &byte, 1) == 0;
  close(descriptor);
  return closed;
}

TEST(PeerUser, IsToldByTheKernel) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  EXPECT_EQ(PeerUser(ends[0]), geteuid());
  close(ends[0]);
  close(ends[1]);
  EXPECT_EQ(PeerUser(ends[0]), std::nullopt);
  const int tcp = socket(AF_INET, SOCK_STREAM, 0);
  EXPECT_EQ(PeerUser(tcp), std::nullopt);
  close(tcp);
}

TEST(PeerUser, OnlyThePermittedMayConnect) {
  EXPECT_TRUE(MayConnect(1000, {1000, 0}));
  EXPECT_TRUE(MayConnect(0, {1000, 0}));
  EXPECT_FALSE(MayConnect(1001, {1000, 0}));
  EXPECT_FALSE(MayConnect(std::nullopt, {1000, 0}));
  EXPECT_FALSE(MayConnect(static_cast<uid_t>(-1), {1000, 0}));
  EXPECT_EQ(OwnUserAndRoot().count(geteuid()), 1u);
  EXPECT_EQ(OwnUserAndRoot().count(0), 1u);
}

class Socket : public ::testing::Test {
 protected:
  // Hands on the first byte that each connection sends.
  void Listen(std::set<uid_t> permitted) {
    auto listener = SocketListener::Listen(*ParseListenAddress("unix:" + path_), permitted);
    ASSERT_TRUE(listener.ok()) << listener.status();
    listener_ = *std::move(listener);
    listener_->Start([this](int descriptor) {
      EXPECT_EQ(fcntl(descriptor, F_GETFD) & FD_CLOEXEC, FD_CLOEXEC);
      EXPECT_EQ(fcntl(descriptor, F_GETFL) & O_NONBLOCK, O_NONBLOCK);
      [[maybe_unused]] const ssize_t written = write(descriptor, "x", 1);
      close(descriptor);
    });
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_.File("socket");
  std::unique_ptr<SocketListener> listener_;
};

TEST_F(Socket, APermittedUserIsHandedOn) {
  Listen(OwnUserAndRoot());
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(IsClosed(Connect(path_)));
}

TEST_F(Socket, AnotherUserIsClosedAndLoggedButNotEveryTime) {
  ::testing::internal::CaptureStderr();
  Listen({kStranger});
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(IsClosed(Connect(path_)));
  listener_->Stop();
  const std::string log = ::testing::internal::GetCapturedStderr();
  EXPECT_LE(std::count(log.begin(), log.end(), '\n'), 10) << log;  // one in 10 s, and at the end
  EXPECT_THAT(log, HasSubstr("1 connection of other users closed, the last of user " +
                             std::to_string(geteuid())));
}

TEST_F(Socket, ItsFileIsItsOwnersFromTheStartAndGoneAtTheEnd) {
  const mode_t before = umask(0);
  auto listener = SocketListener::Listen(*ParseListenAddress("unix:" + path_), {});
  umask(before);
  struct stat found {};
  ASSERT_EQ(stat(path_.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 07777, 0600u);
  (*listener)->Stop();
  (*listener)->Stop();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(Socket, AFileOfAnotherServerAtThePathStays) {
  const auto address = *ParseListenAddress("unix:" + path_);
  auto first = SocketListener::Listen(address, {});
  unlink(path_.c_str());
  auto second = SocketListener::Listen(address, OwnUserAndRoot());
  ASSERT_TRUE(second.ok()) << second.status();
  (*first)->Stop();
  EXPECT_GE(Connect(path_), 0);
  (*second)->Stop();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(Socket, ConnectionsThatComeBeforeTheStartWait) {
  auto listener = SocketListener::Listen(*ParseListenAddress("unix:" + path_), OwnUserAndRoot());
  const int early = Connect(path_);
  (*listener)->Start([](int descriptor) {
    [[maybe_unused]] const ssize_t written = write(descriptor, "x", 1);
    close(descriptor);
  });
  EXPECT_FALSE(IsClosed(early));
}

TEST_F(Socket, WhereNoSocketCanBeThereIsNone) {
  const auto listener =
      SocketListener::Listen(*ParseListenAddress("unix:" + folder_.File("no/such")), {});
  EXPECT_TRUE(absl::IsFailedPrecondition(listener.status()));
  EXPECT_THAT(std::string(listener.status().message()), HasSubstr("No such file"));
}

// A real other user, which takes root.
TEST_F(Socket, AProcessOfAnotherUserIsClosed) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can be somebody else";
  Listen({0});
  chmod(folder_.path().c_str(), 0755);
  chmod(path_.c_str(), 0666);  // so that only the check of the user stands in the way
  const pid_t child = fork();
  if (child == 0) _exit(setuid(kStranger) == 0 && IsClosed(Connect(path_)) ? 0 : 1);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

// By hand: whether a connection to the host's port is accepted.
bool Reaches(int family, const char* host, int port) {
  sockaddr_storage storage{};
  storage.ss_family = static_cast<sa_family_t>(family);
  auto* four = reinterpret_cast<sockaddr_in*>(&storage);
  auto* six = reinterpret_cast<sockaddr_in6*>(&storage);
  four->sin_port = htons(static_cast<uint16_t>(port));
  inet_pton(family, host,
            family == AF_INET ? static_cast<void*>(&four->sin_addr)
                              : static_cast<void*>(&six->sin6_addr));
  const int descriptor = socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const socklen_t size = family == AF_INET ? sizeof(sockaddr_in) : sizeof(sockaddr_in6);
  const bool reached = connect(descriptor, reinterpret_cast<sockaddr*>(&storage), size) == 0;
  close(descriptor);
  return reached;
}

bool HasIpv6() { return SocketListener::Listen(*ParseListenAddress("[::1]:0"), {}).ok(); }

TEST(Port, OneThatIsFreeIsChosenForEveryAddressOfAName) {
  auto listener = SocketListener::Listen(*ParseListenAddress("localhost:0"), {});
  ASSERT_TRUE(listener.ok()) << listener.status();
  const int port = (*listener)->address().port;
  EXPECT_GT(port, 0);
  EXPECT_TRUE(Reaches(AF_INET, "127.0.0.1", port) || Reaches(AF_INET6, "::1", port));
}

TEST(Port, EveryAddressMeansThoseOfEitherKind) {
  for (const char* every : {"0.0.0.0:0", "[::]:0"}) {
    auto listener = SocketListener::Listen(*ParseListenAddress(every), {});
    ASSERT_TRUE(listener.ok()) << listener.status();
    const int port = (*listener)->address().port;
    EXPECT_TRUE(Reaches(AF_INET, "127.0.0.1", port)) << every;
    if (HasIpv6()) {
      EXPECT_TRUE(Reaches(AF_INET6, "::1", port)) << every;
    }
  }
}

TEST(Port, OneInUseIsRefusedWhoeverAsksSecond) {
  for (const char* first : {"127.0.0.1:0", "0.0.0.0:0"}) {
    auto listener = SocketListener::Listen(*ParseListenAddress(first), {});
    ASSERT_TRUE(listener.ok()) << listener.status();
    for (const char* host : {"127.0.0.1:", "0.0.0.0:", "localhost:"}) {
      const auto second = SocketListener::Listen(
          *ParseListenAddress(host + std::to_string((*listener)->address().port)), {});
      EXPECT_TRUE(absl::IsFailedPrecondition(second.status())) << first << " " << host;
      EXPECT_THAT(std::string(second.status().message()), HasSubstr("in use"));
    }
  }
}

TEST(Port, AHostThatIsNotOfThisMachineIsRefused) {
  const auto listener = SocketListener::Listen(*ParseListenAddress("192.0.2.1:0"), {});
  EXPECT_THAT(std::string(listener.status().message()), HasSubstr("--listen=192.0.2.1:0"));
}

class SocketServer : public ::testing::Test {
 protected:
  ServerOptions Options(std::set<uid_t> users) {
    ServerOptions options = SecureOptions({}, folder_.path());
    options.listen = "";
    options.socket_users = std::move(users);
    return options;
  }
  static int OpenDescriptors() {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return static_cast<int>(std::distance(begin(all), end(all)));
  }

  TemporaryFolder folder_;
};

TEST_F(SocketServer, AnotherUserGetsNoAnswer) {
  RunningServer server(Options({kStranger}));
  const grpc::Status status = CallByName(server.channel(), "/grpc.health.v1.Health/Check", "", {});
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE) << status.error_message();
}

TEST_F(SocketServer, ManyConnectionsAreServedAndNoneIsLeftAtTheEnd) {
  const int before = OpenDescriptors();
  {
    RunningServer server(Options(OwnUserAndRoot()));
    for (int i = 0; i < 40; ++i) {
      const auto channel = grpc::CreateCustomChannel(
          server.server().address(), grpc::InsecureChannelCredentials(), [] {
            grpc::ChannelArguments own;
            own.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
            return own;
          }());
      EXPECT_TRUE(CallByName(channel, "/grpc.health.v1.Health/Check", "", {}).ok());
    }
    const int hanging = Connect(server.server().address().substr(5));
    ASSERT_GE(hanging, 0);
    server.server().Shutdown(std::chrono::milliseconds(0));
    close(hanging);
  }
  // gRPC gives its sockets back on threads of its own.
  while (OpenDescriptors() > before + 8) std::this_thread::yield();
}

}  // namespace
}  // namespace ballpiston::server
