#include "client/library/local_server.h"

#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/library/channel.h"
#include "client/library/request_id.h"
#include "client/library/server_address.h"
#include "client/library/server_process.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

constexpr char kIdleSeconds[] = "60";
constexpr absl::Duration kAnswerTimeout = absl::Seconds(10);
// How often to check a server that does not answer yet. A check holds the folder's lock for a
// moment if the lock is free, and must therefore be rare.
constexpr absl::Duration kPoll = absl::Milliseconds(200);
constexpr int kAttempts = 3;

// The environment variable's value if it is an absolute path, else empty.
std::string PathVariable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && value[0] == '/' ? value : "";
}

// Another user may have made the folder. Whoever owns it or can write to it can replace the socket.
// `for_others`: the rights that others must not have.
absl::Status CheckPrivate(const std::string& folder, mode_t for_others) {
  struct stat status;
  if (lstat(folder.c_str(), &status) != 0) return absl::ErrnoToStatus(errno, folder);
  if (!S_ISDIR(status.st_mode)) {
    return absl::PermissionDeniedError("the private server needs a folder, but this is not one: " +
                                       folder);
  }
  const bool is_own = status.st_uid == geteuid();
  if (is_own && (status.st_mode & for_others) == 0) return absl::OkStatus();
  return absl::PermissionDeniedError(absl::StrFormat(
      "the private server's folder %s belongs to user %d and has mode %04o, but must be private: "
      "%s, or choose another one with XDG_STATE_HOME",
      folder, status.st_uid, status.st_mode & 07777,
      is_own ? "run chmod 700 " + folder : "remove it"));
}

// Makes the folder and those above it, each for its owner only. False: an error, which is in errno.
bool MakeFolders(const fs::path& folder) {
  const auto exists = [&] { return mkdir(folder.c_str(), 0700) == 0 || errno == EEXIST; };
  return exists() || (errno == ENOENT && folder.has_relative_path() &&
                      MakeFolders(folder.parent_path()) && exists());
}

absl::Status MakeFolder(const std::string& folder) {
  if (MakeFolders(folder) && access(folder.c_str(), W_OK | X_OK) == 0) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat("the private server needs the folder ", folder, ": ", std::strerror(errno),
                   " (name a server with --server, or another folder with XDG_STATE_HOME)"));
}

absl::StatusOr<std::string> SocketIn(const std::string& folder) {
  const std::string usual = folder + "/server.socket";
  if (IsSocketPath(usual)) return usual;
  std::string root = PathVariable("TMPDIR");
  const std::string name = absl::StrCat("/ballpiston-", getuid(), "-", RequestIdFor(folder));
  constexpr char kSocket[] = "/server.socket";
  if (root.empty() || !IsSocketPath(root + name + kSocket)) root = "/tmp";
  if (absl::Status made = MakeFolder(root + name); !made.ok()) return made;
  if (absl::Status own = CheckPrivate(root + name, 077); !own.ok()) return own;
  return absl::StrCat(root, name, kSocket);
}

// Whether a server answers. Returns false as soon as a connection is refused.
bool Answers(grpc::Channel& channel) {
  const auto deadline = absl::ToChronoTime(absl::Now() + kAnswerTimeout);
  while (true) {
    const grpc_connectivity_state state = channel.GetState(true);
    if (state == GRPC_CHANNEL_READY) return true;
    if (state == GRPC_CHANNEL_TRANSIENT_FAILURE || state == GRPC_CHANNEL_SHUTDOWN) return false;
    if (!channel.WaitForStateChange(state, deadline)) return false;
  }
}

// Waits for a server in the folder of this address, as long as a server holds the folder. That one
// may be of another client, and stop because it was idle: it no longer answers, and soon releases
// the folder.
bool AnswersWhileItRuns(const LocalServer& server, grpc::Channel& channel, absl::Time deadline) {
  while (absl::Now() < deadline && FindServer(server.folder)) {
    if (channel.WaitForConnected(absl::ToChronoTime(absl::Now() + kPoll))) return true;
  }
  return false;
}

absl::Status Start(const LocalServer& server, grpc::Channel& channel) {
  const ServerProgram program = {
      .program = server.program,
      .folder = server.folder,
      .flags = {"--listen", server.Address(), "--idle-exit-seconds", kIdleSeconds}};
  const absl::Time deadline = absl::Now() + server.start_time;
  absl::Status failure;
  for (int attempt = 0; attempt < kAttempts && absl::Now() < deadline; ++attempt) {
    const absl::StatusOr<std::string> address = StartServer(program, deadline - absl::Now());
    if (address.ok() && *address != server.Address()) {
      return absl::UnavailableError(absl::StrCat("the server in ", server.folder, " listens at ",
                                                 *address, ", not at ", server.Address()));
    }
    if (address.ok() && AnswersWhileItRuns(server, channel, deadline)) return absl::OkStatus();
    failure =
        address.ok()
            ? absl::UnavailableError(absl::StrCat("the server at ", *address, " does not answer"))
            : address.status();
    // A server of another client that holds the folder soon answers, or releases it.
    if (FindServer(server.folder)) failure = absl::UnavailableError(failure.message());
  }
  return failure;
}

}  // namespace

std::string HomeFolder() {
  if (std::string home = PathVariable("HOME"); !home.empty()) return home;
  const passwd* user = getpwuid(getuid());
  return user != nullptr ? user->pw_dir : "";
}

std::string StateFolder() {
  if (std::string state = PathVariable("XDG_STATE_HOME"); !state.empty()) {
    return state + "/ballpiston";
  }
  return HomeFolder() + "/.local/state/ballpiston";
}

absl::StatusOr<LocalServer> FindLocalServer() {
  LocalServer server{.folder = StateFolder(), .socket = "", .program = UsualServerProgram()};
  if (absl::Status made = MakeFolder(server.folder); !made.ok()) return made;
  // The folder may be a link. The server itself closes it to readers.
  if (absl::Status own = CheckPrivate(server.folder + "/.", 022); !own.ok()) return own;
  absl::StatusOr<std::string> socket = SocketIn(server.folder);
  if (!socket.ok()) return socket.status();
  server.socket = *std::move(socket);
  return server;
}

absl::StatusOr<std::shared_ptr<grpc::Channel>> ConnectToLocalServer(const LocalServer& server) {
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = OpenChannel(server.Address());
  if (!channel.ok() || Answers(**channel)) return channel;
  if (absl::Status started = Start(server, **channel); !started.ok()) return started;
  return channel;
}

absl::StatusOr<std::shared_ptr<grpc::Channel>> ConnectIfRunning(const LocalServer& server) {
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = OpenChannel(server.Address());
  if (!channel.ok() || Answers(**channel)) return channel;
  return absl::UnavailableError(absl::StrCat(
      "no private server is running (a command that needs it starts it in ", server.folder, ")"));
}

}  // namespace ballpiston::client
