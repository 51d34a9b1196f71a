// A Unix socket that several users may open: each is a principal of their own.
#include "server/security/unix_users.h"

#include <fcntl.h>
#include <grp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "ballpiston/v1/server.grpc.pb.h"
#include "gmock/gmock.h"
#include "grpcpp/create_channel_posix.h"
#include "gtest/gtest.h"
#include "server/security/authenticator.h"
#include "server/security/peer_user.h"
#include "tests/server/api/watch_stream.h"
#include "tests/server/call_by_name.h"
#include "tests/server/error_details.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/support/files.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Users of every Debian system, a user without a name, and the number for unmapped users.
constexpr uid_t kDaemon = 1, kBin = 2, kNameless = 54'321, kUnmapped = 65'534;

// ---- without a server: connections of invented users ----

// Answers each call, and remembers who made it: "daemon submit".
class Listening : public v1::ServerService::Service {
 public:
  grpc::Status GetServerStatus(grpc::ServerContext* context, const v1::GetServerStatusRequest*,
                               v1::ServerStatus*) override {
    const auto user = UnixUserOf(*context->auth_context());
    const std::lock_guard lock(mutex_);
    callers_.insert(user ? user->name + " " + RoleName(user->role) : "nobody");
    return grpc::Status::OK;
  }

  std::set<std::string> callers() const {
    const std::lock_guard lock(mutex_);
    return callers_;
  }

 private:
  mutable std::mutex mutex_;
  std::set<std::string> callers_;
};

// At a socket in a file, because gRPC looks at the address of its own end.
struct Ends {
  int server = -1;
  int client = -1;
};

class UnixUsersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (geteuid() == kDaemon || geteuid() == kBin) GTEST_SKIP() << "runs as one of these users";
  }
  void Start(size_t most) {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    users_.emplace(builder, most);
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
  }
  ~UnixUsersTest() override {
    if (server_ != nullptr) server_->Shutdown();
  }

  Ends Connect() {
    Ends ends;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = folder_.File(std::to_string(connections_++));
    std::memcpy(address.sun_path, path.data(), path.size());
    const int listening = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const auto* at = reinterpret_cast<const sockaddr*>(&address);
    EXPECT_EQ(bind(listening, at, sizeof(address)), 0);
    EXPECT_EQ(listen(listening, 1), 0);
    ends.client = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(connect(ends.client, at, sizeof(address)), 0);
    ends.server = accept4(listening, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    fcntl(ends.client, F_SETFL, O_NONBLOCK);
    close(listening);
    return ends;
  }

  // A channel over a connection that gRPC treats as this user's.
  std::shared_ptr<grpc::Channel> As(uid_t user) {
    const Ends ends = Connect();
    users_->Receive(ends.server, user);
    return grpc::CreateInsecureChannelFromFd("test", ends.client);
  }

  static grpc::Status Call(const std::shared_ptr<grpc::Channel>& channel) {
    grpc::ClientContext context;
    v1::ServerStatus status;
    return v1::ServerService::NewStub(channel)->GetServerStatus(&context, {}, &status);
  }

  TemporaryFolder folder_;
  int connections_ = 0;
  Listening service_;
  std::optional<UnixUsers> users_;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(UnixUsersTest, EachCallKnowsTheUserOfItsConnection) {
  Start(3);
  const auto daemon = As(kDaemon), bin = As(kBin), again = As(kDaemon), own = As(geteuid());
  EXPECT_OK(Call(daemon));
  EXPECT_THAT(service_.callers(), ElementsAre("daemon submit"));
  for (const auto& channel : {bin, again, own}) EXPECT_OK(Call(channel));
  EXPECT_THAT(service_.callers(), ElementsAre("bin submit", "daemon submit",
                                              UserName(geteuid()).value_or("local") + " admin"));
}

TEST_F(UnixUsersTest, FirstCallsAtOnceAgreeOnTheUser) {
  Start(1);
  const auto channel = As(kBin);
  std::vector<std::thread> callers;
  for (int i = 0; i < 8; ++i) {
    callers.emplace_back([&] {
      for (int calls = 0; calls < 20; ++calls) EXPECT_OK(Call(channel));
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_THAT(service_.callers(), ElementsAre("bin submit"));
}

TEST_F(UnixUsersTest, ExcessAndUnnamedUsersAreClosedAndLogged) {
  Start(1);
  ::testing::internal::CaptureStderr();
  EXPECT_THAT(Call(As(kNameless)), StatusIs(grpc::StatusCode::UNAVAILABLE));
  EXPECT_OK(Call(As(kDaemon)));  // the nameless user has not taken the only place
  EXPECT_THAT(Call(As(kBin)), StatusIs(grpc::StatusCode::UNAVAILABLE));
  EXPECT_OK(Call(As(kDaemon)));
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr("connection of user 54321 closed: the system has no name for this user"));
  EXPECT_THAT(service_.callers(), ElementsAre("daemon submit"));
}

TEST(PeerUser, TheUserNobodyStandsForNoUserInANamespace) {
  EXPECT_TRUE(StandsForOneUser(kDaemon));
  EXPECT_TRUE(StandsForOneUser(0));
  EXPECT_FALSE(StandsForOneUser(std::nullopt));
  EXPECT_FALSE(
      StandsForOneUser(static_cast<uid_t>(std::stoul(Contents("/proc/sys/kernel/overflowuid")))));
  EXPECT_EQ(UserName(kDaemon), "daemon");
  EXPECT_EQ(UserName(kNameless), std::nullopt);
}

// ---- the file ----

class SocketFile : public ::testing::Test {
 protected:
  // "MODE GROUP" of the socket of a server with these options, or the error.
  std::string Made(SecurityOptions security) {
    const std::string path = folder_.File("socket");
    const absl::Status error = StartError({.listen = "unix:" + path, .security = security});
    if (!error.ok()) return std::string(error.message());
    RunningServer server({.listen = "unix:" + path, .security = std::move(security)});
    struct stat found {};
    EXPECT_EQ(stat(path.c_str(), &found), 0);
    EXPECT_EQ(found.st_uid, geteuid());
    char text[32];
    std::snprintf(text, sizeof(text), "%04o %u", found.st_mode & 07777u, found.st_gid);
    return text;
  }

  TemporaryFolder folder_;
};

TEST_F(SocketFile, HasTheModeAndTheGroupThatTheFlagsGive) {
  const std::string group = std::to_string(getegid());
  const mode_t before = umask(0077);  // as in the server program
  EXPECT_EQ(Made({}), "0600 " + group);
  EXPECT_EQ(Made({.socket_mode = 0666}), "0666 " + group);
  EXPECT_EQ(Made({.socket_mode = 0660, .socket_group = group}), "0660 " + group);
  if (const auto* own = getgrgid(getegid())) {
    EXPECT_EQ(Made({.socket_mode = 0660, .socket_group = own->gr_name}), "0660 " + group);
  }
  umask(before);
}

TEST_F(SocketFile, IsNotMadeForAGroupThatDoesNotExist) {
  for (const char* group : {"no-such-group", "4294967295", "-1", "1.5"}) {
    const std::string error = Made({.socket_mode = 0660, .socket_group = group});
    EXPECT_THAT(error, HasSubstr(std::string("--socket-group=") + group));
    EXPECT_THAT(error, HasSubstr("permitted: the name or the number of a group"));
    EXPECT_FALSE(std::filesystem::exists(folder_.File("socket")));
  }
}

TEST_F(SocketFile, IsRemovedIfTheServerMayNotGiveItToTheGroup) {
  if (geteuid() == 0) GTEST_SKIP() << "root may give a file to any group";
  const std::string error = Made({.socket_mode = 0660, .socket_group = "0"});
  EXPECT_THAT(error, HasSubstr("--socket-group: "));
  EXPECT_THAT(error, HasSubstr("permitted: a group that the server's user belongs to"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("socket")));
}

TEST_F(SocketFile, IsNotOpenedToOthersInTheDataFolder) {
  EXPECT_THAT(StartError({.security = {.socket_mode = 0666}}),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       HasSubstr("--socket-mode=0666 needs --listen=unix:PATH")));
}

// ---- a whole server, and real users ----

// Connects on a thread that becomes this user, with this group alone. The system call changes one
// thread; setresuid of the C library would change all. Negative: -errno.
int ConnectAs(uid_t user, gid_t group, const std::string& path) {
  int result = -1;
  std::thread([&] {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const bool is_user = syscall(SYS_setgroups, 0, nullptr) == 0 &&
                         syscall(SYS_setresgid, group, group, group) == 0 &&
                         syscall(SYS_setresuid, user, user, user) == 0;
    EXPECT_TRUE(is_user) << std::strerror(errno);
    const auto* at = reinterpret_cast<const sockaddr*>(&address);
    result = is_user && connect(descriptor, at, sizeof(address)) == 0 ? descriptor : -errno;
    if (result < 0) close(descriptor);
  }).join();
  if (result >= 0) fcntl(result, F_SETFL, O_NONBLOCK);
  return result;
}

class SharedSocket : public ::testing::Test {
 protected:
  void SetUp() override {
    if (geteuid() != 0) GTEST_SKIP() << "only root can connect as other users";
    chmod(folder_.path().c_str(), 0755);
  }

  void Start(SecurityOptions security) {
    server_.emplace(TestServerOptions{.listen = "unix:" + path_, .security = std::move(security)});
  }
  int Connect(uid_t user) const { return ConnectAs(user, user, path_); }
  TestClient As(uid_t user) const {
    const int descriptor = Connect(user);
    if (descriptor < 0) throw std::runtime_error(std::strerror(-descriptor));
    return TestClient(grpc::CreateInsecureChannelFromFd("test", descriptor));
  }
  SecurityOptions WithList(const std::string& text) const {
    WriteFile(list_, text);
    chmod(list_.c_str(), 0600);
    return {.access_file = list_, .socket_mode = 0666};
  }
  static grpc::Status List(TestClient& client) { return CallByName(client.channel(), kListJobs); }

  TemporaryFolder folder_;
  const std::string path_ = folder_.File("socket");
  const std::string list_ = folder_.File("access");
  std::optional<RunningServer> server_;
};

TEST_F(SharedSocket, JobsBelongToTheUserAndAreHiddenFromOthers) {
  Start({.socket_mode = 0666});
  TestClient daemon = As(kDaemon), bin = As(kBin), root = As(0);
  const v1::EnsembleJob job = daemon.Created(CreateRequest(Equilibrium(1, 2)));
  EXPECT_EQ(job.principal(), "daemon");
  EXPECT_EQ(bin.List().jobs_size(), 0);
  v1::EnsembleJob same = bin.Created(CreateRequest(Equilibrium(1, 2)));
  EXPECT_NE(same.name(), job.name());
  const std::string name = "\x0a" + std::string(1, static_cast<char>(job.name().size()));
  EXPECT_EQ(ReasonOf(CallByName(bin.channel(), kGetJob, name + job.name())), "JOB_NOT_FOUND");
  EXPECT_EQ(ReasonOf(WatchStream(bin, job.name()).End()), "JOB_NOT_FOUND");
  EXPECT_EQ(ReasonOf(bin.Cancel(job.name())), "JOB_NOT_FOUND");
  EXPECT_EQ(ReasonOf(bin.Delete(job.name())), "JOB_NOT_FOUND");
  EXPECT_EQ(daemon.AwaitEnd(job.name()).state(), v1::EnsembleJob::SUCCEEDED);
  EXPECT_EQ(root.List().jobs_size(), 2);
  EXPECT_EQ(root.Created(CreateRequest(Equilibrium(2, 2))).principal(), "root");
}

TEST_F(SharedSocket, OnlyMembersOfTheGroupConnectWithMode0660) {
  Start({.socket_mode = 0660, .socket_group = "daemon"});
  EXPECT_OK(List(*std::make_unique<TestClient>(As(kDaemon))));
  EXPECT_EQ(Connect(kBin), -EACCES);
  const int member = ConnectAs(kBin, kDaemon, path_);
  TestClient bin(grpc::CreateInsecureChannelFromFd("test", member));
  EXPECT_EQ(bin.Created(CreateRequest(Equilibrium(1, 2))).principal(), "bin");
}

TEST_F(SharedSocket, UsersOfOtherNamespacesAreClosed) {
  ::testing::internal::CaptureStderr();
  Start({.socket_mode = 0666});
  TestClient unmapped = As(kUnmapped);
  EXPECT_THAT(List(unmapped), StatusIs(grpc::StatusCode::UNAVAILABLE));
  server_.reset();  // the line may come after the call has failed
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr("1 connection of users outside this user namespace"));
}

TEST_F(SharedSocket, AnAccessFileAdmitsItsUsersWithTheirRoles) {
  Start(WithList("user daemon ada read\nuser games ben admin\n"));
  TestClient daemon = As(kDaemon), bin = As(kBin), games = As(5), root = As(0);
  EXPECT_THAT(List(bin), StatusIs(grpc::StatusCode::UNAUTHENTICATED, HasSubstr("user bin")));
  EXPECT_EQ(ReasonOf(List(bin)), "CREDENTIALS_INVALID");
  EXPECT_OK(List(daemon));
  EXPECT_EQ(ReasonOf(daemon.Create(CreateRequest(Equilibrium(1, 2)))), "ROLE_TOO_LOW");
  const v1::EnsembleJob job = root.Created(CreateRequest(Equilibrium(1, 2)));
  EXPECT_EQ(games.Get(job.name()).principal(), "root");
  WithList("user bin ada submit\n");
  ASSERT_OK(server_->server().Reload());
  EXPECT_EQ(bin.Created(CreateRequest(Equilibrium(1, 2))).principal(), "ada");
  EXPECT_EQ(ReasonOf(List(daemon)), "CREDENTIALS_INVALID");
  EXPECT_OK(List(root));
}

TEST_F(SharedSocket, ATokenOrAFileWithTokensOnlyDoesNotReplaceTheUser) {
  EXPECT_THAT(
      StartError({.listen = "unix:" + path_, .security = WithList("certificate box box read\n")}),
      StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("only lines of the kind user")));
  Start(WithList("user daemon ada submit\n"));
  TestClient bin = As(kBin);
  EXPECT_EQ(ReasonOf(CallByName(bin.channel(), kListJobs, "", Bearer("token"))),
            "CREDENTIALS_INVALID");
}

// The private server of one user is as it was.
TEST(PrivateSocket, ItsPrincipalIsLocalAnAdministrator) {
  const TemporaryFolder data, folder;
  std::string job;
  {
    RunningServer shared({.data_dir = data.path(),
                          .listen = "unix:" + folder.File("socket"),
                          .security = {.socket_mode = 0666}});
    job = shared.Submit(Equilibrium(1, 2));
  }
  for (const SecurityOptions& security :
       {SecurityOptions(), SecurityOptions{.socket_mode = 0600}}) {
    RunningServer server({.data_dir = data.path(), .security = security});
    EXPECT_EQ(server.Created(CreateRequest(Equilibrium(1, 2))).principal(), "local");
    EXPECT_EQ(server.Get(job).principal(), UserName(geteuid()).value_or("local"));
  }
}

}  // namespace
}  // namespace ballpiston::server
