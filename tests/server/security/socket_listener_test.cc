#include "server/security/socket_listener.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/security/peer_user.h"
#include "tests/server/call_by_name.h"
#include "tests/server/running_server.h"
#include "tests/support/await.h"
#include "tests/support/files.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace {
bool next_port_is_taken = false;
}

// Replaces the C library's function in this program.
extern "C" int listen(int descriptor, int waiting) noexcept {
  if (!std::exchange(next_port_is_taken, false)) {
    return static_cast<int>(syscall(SYS_listen, descriptor, waiting));
  }
  errno = EADDRINUSE;
  return -1;
}

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;

constexpr uid_t kStranger = 65534;

int ConnectTo(const std::string& path) {
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

// Whether the other side closes the connection without sending data.
bool IsClosed(int descriptor) {
  char byte;
  const bool closed = read(descriptor, &byte, 1) == 0;
  close(descriptor);
  return closed;
}

TEST(PeerUser, IsTheUserThatTheKernelReports) {
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

TEST(PeerUser, OnlyPermittedUsersMayConnect) {
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
  // Sends a byte to each connection that it accepts.
  void Listen(std::set<uid_t> permitted) {
    ASSERT_OK_AND_ASSIGN(listener_,
                         SocketListener::Listen(*ParseListenAddress("unix:" + path_), permitted));
    listener_->Start([](int descriptor, std::optional<uid_t>) {
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

TEST_F(Socket, APermittedUserIsAccepted) {
  Listen(OwnUserAndRoot());
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(IsClosed(ConnectTo(path_)));
}

TEST_F(Socket, OtherUsersAreClosedAndSometimesLogged) {
  ::testing::internal::CaptureStderr();
  Listen({kStranger});
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(IsClosed(ConnectTo(path_)));
  listener_->Stop();
  const std::string log = ::testing::internal::GetCapturedStderr();
  EXPECT_LE(std::count(log.begin(), log.end(), '\n'), 10) << log;  // one in 10 s, and at the end
  EXPECT_THAT(log, HasSubstr("1 connection of other users closed, the last of user " +
                             std::to_string(geteuid())));
}

TEST_F(Socket, ItsFileHasMode0600AndIsRemovedAtTheEnd) {
  const mode_t before = umask(0);
  auto listener = SocketListener::Listen(*ParseListenAddress("unix:" + path_), {});
  umask(before);
  EXPECT_EQ(ModeOf(path_), 0600u);
  (*listener)->Stop();
  (*listener)->Stop();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(Socket, AFileOfAnotherServerAtThePathStays) {
  const auto address = *ParseListenAddress("unix:" + path_);
  auto first = SocketListener::Listen(address, {});
  unlink(path_.c_str());
  ASSERT_OK_AND_ASSIGN(auto second, SocketListener::Listen(address, OwnUserAndRoot()));
  (*first)->Stop();
  EXPECT_GE(ConnectTo(path_), 0);
  second->Stop();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(Socket, ConnectionsBeforeTheStartWait) {
  auto listener = SocketListener::Listen(*ParseListenAddress("unix:" + path_), OwnUserAndRoot());
  const int early = ConnectTo(path_);
  (*listener)->Start([](int descriptor, std::optional<uid_t>) {
    [[maybe_unused]] const ssize_t written = write(descriptor, "x", 1);
    close(descriptor);
  });
  EXPECT_FALSE(IsClosed(early));
}

TEST_F(Socket, APathWithoutAFolderIsRefused) {
  const auto listener =
      SocketListener::Listen(*ParseListenAddress("unix:" + folder_.File("no/such")), {});
  EXPECT_THAT(listener, StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("No such file")));
}

// A real other user; the test needs root.
TEST_F(Socket, AProcessOfAnotherUserIsClosed) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can be somebody else";
  Listen({0});
  chmod(folder_.path().c_str(), 0755);
  chmod(path_.c_str(), 0666);  // so that only the check of the user can reject
  const pid_t child = fork();
  if (child == 0) _exit(setuid(kStranger) == 0 && IsClosed(ConnectTo(path_)) ? 0 : 1);
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

TEST(Port, PortZeroChoosesAFreePort) {
  ASSERT_OK_AND_ASSIGN(auto listener,
                       SocketListener::Listen(*ParseListenAddress("localhost:0"), {}));
  const int port = listener->address().port;
  EXPECT_GT(port, 0);
  EXPECT_TRUE(Reaches(AF_INET, "127.0.0.1", port) || Reaches(AF_INET6, "::1", port));
}

TEST(Port, PortZeroChoosesAnotherPortIfTheFirstIsTaken) {
  next_port_is_taken = true;
  EXPECT_OK(SocketListener::Listen(*ParseListenAddress("127.0.0.1:0"), {}));
  EXPECT_FALSE(next_port_is_taken);
}

TEST(Port, AnyAddressMeansIpv4AndIpv6) {
  for (const char* every : {"0.0.0.0:0", "[::]:0"}) {
    ASSERT_OK_AND_ASSIGN(auto listener, SocketListener::Listen(*ParseListenAddress(every), {}));
    const int port = listener->address().port;
    EXPECT_TRUE(Reaches(AF_INET, "127.0.0.1", port)) << every;
    if (HasIpv6()) {
      EXPECT_TRUE(Reaches(AF_INET6, "::1", port)) << every;
    }
  }
}

TEST(Port, APortInUseIsRefused) {
  for (const char* first : {"127.0.0.1:0", "0.0.0.0:0"}) {
    ASSERT_OK_AND_ASSIGN(auto listener, SocketListener::Listen(*ParseListenAddress(first), {}));
    for (const char* host : {"127.0.0.1:", "0.0.0.0:", "localhost:"}) {
      const auto second = SocketListener::Listen(
          *ParseListenAddress(host + std::to_string(listener->address().port)), {});
      EXPECT_THAT(second, StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")))
          << first << " " << host;
    }
  }
}

TEST(Port, AHostThatIsNotOfThisMachineIsRefused) {
  const auto listener = SocketListener::Listen(*ParseListenAddress("192.0.2.1:0"), {});
  EXPECT_THAT(std::string(listener.status().message()), HasSubstr("--listen=192.0.2.1:0"));
}

int OpenDescriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<int>(std::distance(begin(all), end(all)));
}

TEST(SocketServer, AnotherUserGetsNoAnswer) {
  RunningServer server({.socket_users = {kStranger}});
  EXPECT_THAT(CallByName(server.channel(), kCheckHealth), StatusIs(grpc::StatusCode::UNAVAILABLE));
}

TEST(SocketServer, ManyConnectionsAreServedAndAllAreClosedAtTheEnd) {
  const int before = OpenDescriptors();
  {
    RunningServer server;
    for (int i = 0; i < 40; ++i) EXPECT_OK(CallByName(server.NewChannel(), kCheckHealth));
    const int hanging = ConnectTo(server.address().substr(5));
    ASSERT_GE(hanging, 0);
    server.Shutdown();
    close(hanging);
  }
  // gRPC gives its sockets back on threads of its own.
  AwaitThat([&] { return OpenDescriptors() <= before + 8; });
}

}  // namespace
}  // namespace ballpiston::server
