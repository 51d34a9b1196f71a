#include "client/library/local_server.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <stop_token>
#include <thread>

#include "client/library/server_address.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

// Runs with an empty HOME, and without the variables that choose the server.
class LocalServerTest : public ::testing::Test {
 protected:
  // A program that runs the shell script.
  std::string Program(const std::string& script) const {
    const fs::path path = home_ / "program";
    WriteFile(path, std::string("#!/bin/sh\n") + script + "\n");
    fs::permissions(path, fs::perms::owner_all);
    return path.string();
  }

  const TemporaryFolder folder_;
  const fs::path home_ = folder_.path();
  const ScopedVariable home_variable_{"HOME", home_};
  const ScopedVariable state_home_{"XDG_STATE_HOME"};
  const ScopedVariable server_program_{"BALLPISTON_SERVER_PROGRAM"};
  const ScopedVariable temporary_{"TMPDIR"};
};

TEST_F(LocalServerTest, IsInTheStateFolderOfTheUser) {
  ASSERT_OK_AND_ASSIGN(const LocalServer server, FindLocalServer());
  EXPECT_EQ(server.folder, home_.string() + "/.local/state/ballpiston");
  EXPECT_EQ(server.socket, server.folder + "/server.socket");
  EXPECT_EQ(ModeOf(server.folder), 0700u);
}

TEST_F(LocalServerTest, FollowsXdgStateHome) {
  state_home_.Set((home_ / "state").string());
  EXPECT_EQ(FindLocalServer()->folder, home_.string() + "/state/ballpiston");
  state_home_.Set("relative");  // the XDG specification says: ignore it
  EXPECT_EQ(FindLocalServer()->folder, home_.string() + "/.local/state/ballpiston");
}

TEST_F(LocalServerTest, ALongPathHasItsSocketInAPrivateFolderElsewhere) {
  home_variable_.Set((home_ / std::string(100, 'x')).string());
  temporary_.Set(home_.string());
  ASSERT_OK_AND_ASSIGN(const LocalServer server, FindLocalServer());
  EXPECT_THAT(server.socket, StartsWith(home_.string() + "/ballpiston-"));
  EXPECT_LE(server.socket.size(), kMaxSocketPath);
  EXPECT_EQ(FindLocalServer()->socket, server.socket);
  const fs::path folder = fs::path(server.socket).parent_path();
  EXPECT_EQ(ModeOf(folder), 0700u);
  fs::permissions(folder, fs::perms::all);  // others can enter it
  EXPECT_THAT(FindLocalServer(), StatusIs(absl::StatusCode::kPermissionDenied));
}

TEST_F(LocalServerTest, ErrorNamesAStateFolderThatCannotBeMade) {
  WriteFile(home_ / "file", "not a folder");
  home_variable_.Set((home_ / "file").string());
  EXPECT_THAT(FindLocalServer(), StatusIs(absl::StatusCode::kPermissionDenied,
                                          HasSubstr(home_.string() + "/file/.local")));
}

TEST_F(LocalServerTest, TheEnvironmentCanSetTheProgram) {
  EXPECT_THAT(FindLocalServer()->program, EndsWith("ballpistond"));
  server_program_.Set("/opt/server");
  EXPECT_EQ(FindLocalServer()->program, "/opt/server");
  server_program_.Set("bin/server");
  EXPECT_EQ(FindLocalServer()->program, (fs::current_path() / "bin/server").string());
}

TEST_F(LocalServerTest, UsesAServerThatAnswers) {
  FakeServer running;
  running.Start();
  const LocalServer server{
      .folder = home_.string(), .socket = running.SocketPath(), .program = Program("exit 1")};
  EXPECT_OK(ConnectToLocalServer(server));
  EXPECT_FALSE(fs::exists(home_ / "server.log"));  // no program was started
}

// Holds the lock of the folder, as a server of another client does.
class FolderInUse {
 public:
  explicit FolderInUse(const fs::path& folder)
      : lock_(open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    EXPECT_EQ(flock(lock_, LOCK_EX | LOCK_NB), 0);
  }
  ~FolderInUse() { Leave(); }
  FolderInUse(const FolderInUse&) = delete;
  FolderInUse& operator=(const FolderInUse&) = delete;

  void Leave() {
    if (lock_ >= 0) close(lock_);
    lock_ = -1;
  }

 private:
  int lock_;
};

// Waits until the file exists or a stop is requested.
void AwaitFile(const fs::path& file, const std::stop_token& stop) {
  AwaitThat([&] { return fs::exists(file) || stop.stop_requested(); });
}

// Counts how often a file is opened.
class Openings {
 public:
  explicit Openings(const fs::path& file) : descriptor_(inotify_init1(IN_CLOEXEC | IN_NONBLOCK)) {
    EXPECT_GE(inotify_add_watch(descriptor_, file.c_str(), IN_OPEN), 0);
  }
  ~Openings() { close(descriptor_); }
  Openings(const Openings&) = delete;
  Openings& operator=(const Openings&) = delete;

  // Waits until the file has been opened so often from now on, or a stop is requested.
  void Await(int count, const std::stop_token& stop) {
    while (Read() > 0) continue;  // earlier ones
    int seen = 0;
    AwaitThat([&] { return (seen += Read()) >= count || stop.stop_requested(); });
  }

 private:
  // Openings since the last call. The kernel may report equal ones as one.
  int Read() {
    inotify_event event;
    return read(descriptor_, &event, sizeof(event)) == sizeof(event) ? 1 : 0;
  }

  const int descriptor_;
};

// The started program exits, because another server holds the folder. The client starts no second
// program, but waits until that server listens. It looks at the lock again and again meanwhile.
TEST_F(LocalServerTest, WaitsForAnotherClientsServer) {
  FakeServer other;
  const FolderInUse in_use(home_);
  const LocalServer server{.folder = home_.string(),
                           .socket = other.SocketPath(),
                           .program = Program("cd " + home_.string() +
                                              "; [ -e once ] && touch twice; touch once; exit 1"),
                           .start_time = absl::FromChrono(kPatience)};
  Openings looks(home_ / "lock");
  std::jthread starter([&](const std::stop_token& stop) {
    AwaitFile(home_ / "once", stop);
    looks.Await(6, stop);
    other.Start();
  });
  EXPECT_OK(ConnectToLocalServer(server));
  starter.request_stop();
  EXPECT_FALSE(fs::exists(home_ / "twice"));
  starter.join();
}

TEST_F(LocalServerTest, DoesNotWaitForAServerThatListensElsewhere) {
  const LocalServer server{.folder = home_.string(),
                           .socket = home_ / "socket",
                           .program = Program("echo why; exit 2"),
                           .start_time = absl::FromChrono(kUnreachedLimit)};
  const FolderInUse in_use(home_);
  WriteFile(home_ / "server.address", "127.0.0.1:50051\n");
  EXPECT_THAT(
      ConnectToLocalServer(server),
      StatusIs(absl::StatusCode::kUnavailable, HasSubstr("ended at once with exit status 2: why")));
}

// The other server ends: the program is started again, and runs until the test's folder is removed.
TEST_F(LocalServerTest, StartsAServerWhenAnotherLeavesTheFolder) {
  FakeServer second;
  FolderInUse in_use(home_);
  const LocalServer server{.folder = home_.string(),
                           .socket = second.SocketPath(),
                           .program = Program("cd " + home_.string() +
                                              "; if [ -e once ]; then touch twice;"
                                              " while [ -e once ]; do sleep 0.01; done; exit 1; fi;"
                                              " touch once; exit 1"),
                           .start_time = absl::FromChrono(kPatience)};
  std::jthread starter([&](const std::stop_token& stop) {
    AwaitFile(home_ / "once", stop);
    in_use.Leave();
    AwaitFile(home_ / "twice", stop);
    second.Start();
  });
  EXPECT_OK(ConnectToLocalServer(server));
  starter.request_stop();
  starter.join();
}

}  // namespace
}  // namespace ballpiston::client
