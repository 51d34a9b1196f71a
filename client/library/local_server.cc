#include "client/library/local_server.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/library/channel.h"
#include "client/library/child_process.h"
#include "client/library/server_address.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

constexpr char kProgramName[] = "ballpistond";
constexpr char kIdleSeconds[] = "60";
constexpr absl::Duration kAnswerTimeout = absl::Seconds(10);
constexpr absl::Duration kPoll = absl::Milliseconds(20);

// While another client's server holds the folder and does not answer yet. To look takes the lock
// for a moment if nobody has it: not too often.
constexpr absl::Duration kOthersPoll = absl::Milliseconds(200);

constexpr uintmax_t kMaxLogBytes = 1 << 20;

// A server locks the one file in its folder as long as it lives, and tells in the other one where
// it listens (server/store/data_directory.h).
constexpr char kLockFile[] = "lock";
constexpr char kAddressFile[] = "server.address";

// The program exits if another server holds the folder. One that is going idle does not answer any
// more, but leaves the folder.
constexpr int kAttempts = 3;

// An absolute path from the environment, else empty.
std::string PathVariable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && value[0] == '/' ? value : "";
}

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

// FNV-1a: names the socket's folder after the data folder, the same in every version.
uint64_t Hash(const std::string& text) {
  uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

// Anybody may have made a folder of that name below /tmp: use it only if it is the user's own.
absl::Status CheckPrivate(const std::string& folder) {
  struct stat status;
  if (lstat(folder.c_str(), &status) != 0) return absl::ErrnoToStatus(errno, folder);
  if (!S_ISDIR(status.st_mode) || status.st_uid != getuid() || (status.st_mode & 077) != 0) {
    return absl::PermissionDeniedError(
        absl::StrCat(folder, " is not a folder that only this user can enter"));
  }
  return absl::OkStatus();
}

absl::Status MakeFolder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(fs::path(folder).parent_path(), error);
  if (!error && mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    error.assign(errno, std::generic_category());
  }
  if (!error && access(folder.c_str(), W_OK | X_OK) != 0) {
    error.assign(errno, std::generic_category());
  }
  if (!error) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat("no private server without the folder ", folder, ": ", error.message(),
                   " (name a server with --server, or another folder with XDG_STATE_HOME)"));
}

absl::StatusOr<std::string> SocketIn(const std::string& folder) {
  const std::string usual = folder + "/server.socket";
  if (usual.size() <= kMaxSocketPath) return usual;
  std::string root = PathVariable("TMPDIR");
  const std::string name = absl::StrFormat("/ballpiston-%d-%016x", getuid(), Hash(folder));
  constexpr char kSocket[] = "/server.socket";
  if (root.empty() || root.size() + name.size() + sizeof(kSocket) > kMaxSocketPath) root = "/tmp";
  if (absl::Status made = MakeFolder(root + name); !made.ok()) return made;
  if (absl::Status own = CheckPrivate(root + name); !own.ok()) return own;
  return absl::StrCat(root, name, kSocket);
}

std::string Program() {
  const char* chosen = std::getenv("BALLPISTON_SERVER_PROGRAM");
  std::error_code error;
  if (chosen != nullptr && chosen[0] != '\0') {
    // The server starts in another folder: a relative path has to be made absolute here.
    const bool is_path = absl::string_view(chosen).find('/') != absl::string_view::npos;
    return is_path ? fs::absolute(chosen, error).string() : chosen;
  }
  const std::string beside = ProgramBeside(kProgramName);
  return access(beside.c_str(), X_OK) == 0 ? beside : kProgramName;
}

// Whether somebody answers; false as soon as a connection is refused.
bool Answers(grpc::Channel& channel) {
  const auto deadline = absl::ToChronoTime(absl::Now() + kAnswerTimeout);
  while (true) {
    const grpc_connectivity_state state = channel.GetState(true);
    if (state == GRPC_CHANNEL_READY) return true;
    if (state == GRPC_CHANNEL_TRANSIENT_FAILURE || state == GRPC_CHANNEL_SHUTDOWN) return false;
    if (!channel.WaitForStateChange(state, deadline)) return false;
  }
}

bool AnswersWithin(grpc::Channel& channel, absl::Duration time) {
  return channel.WaitForConnected(absl::ToChronoTime(absl::Now() + time));
}

// Whether a server lives there, answering or not.
bool IsInUse(const std::string& folder) {
  const int file = open((folder + "/" + kLockFile).c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool locked = flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(file);
  return locked;
}

// Whether the server that lives there is one that clients start, and not somebody's with an address
// of its own.
bool ListensOrWill(const LocalServer& server) {
  std::string address;
  std::getline(std::ifstream(server.folder + "/" + kAddressFile), address);
  return address.empty() || address == server.Address();
}

class Starter {
 public:
  Starter(const LocalServer& server, grpc::Channel& channel) : server_(server), channel_(channel) {}

  absl::Status Start() {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      if (absl::Status started = StartProgram(); !started.ok()) return started;
      if (AnswersWhileAlive()) return absl::OkStatus();
      if (!exit_status_) return Failure("does not answer");
      if (OtherAnswersWhileAlive()) return absl::OkStatus();
    }
    return Failure(absl::StrCat("ended at once with exit status ", *exit_status_));
  }

 private:
  absl::Status StartProgram() {
    exit_status_.reset();
    LimitLog();
    std::error_code error;
    log_start_ = fs::file_size(server_.Log(), error);
    if (error) log_start_ = 0;
    absl::StatusOr<pid_t> pid =
        StartChild({.command = {server_.program, "--listen", server_.Address(), "--data-dir",
                                server_.folder, "--idle-exit-seconds", kIdleSeconds},
                    .folder = "/",
                    .output = server_.Log(),
                    .detached = true});
    if (!pid.ok()) return absl::UnavailableError(pid.status().message());
    pid_ = *pid;
    return absl::OkStatus();
  }

  void LimitLog() const {
    std::error_code error;
    if (fs::file_size(server_.Log(), error) <= kMaxLogBytes || error) return;
    fs::rename(server_.Log(), server_.Log() + ".old", error);
  }

  // Until it answers, or exits, or time is up.
  bool AnswersWhileAlive() {
    const absl::Time deadline = absl::Now() + server_.start_time;
    while (absl::Now() < deadline) {
      if (AnswersWithin(channel_, kPoll)) return true;
      if ((exit_status_ = ExitStatus(pid_))) return false;
    }
    return false;
  }

  // Another client's, while it holds the folder.
  bool OtherAnswersWhileAlive() {
    while (absl::Now() < others_deadline_ && IsInUse(server_.folder) && ListensOrWill(server_)) {
      if (AnswersWithin(channel_, kOthersPoll)) return true;
    }
    return false;
  }

  // The last line that was written since the program was started.
  std::string LastLine() const {
    std::ifstream log(server_.Log());
    log.seekg(static_cast<std::streamoff>(log_start_));
    std::string last;
    for (std::string line; std::getline(log, line);) {
      if (!line.empty()) last = line;
    }
    return last.empty() ? "(it wrote nothing)" : last;
  }

  absl::Status Failure(absl::string_view what) const {
    return absl::UnavailableError(absl::StrCat("the private server ", server_.program, " ", what,
                                               ": ", LastLine(), "\n  log: ", server_.Log()));
  }

  const LocalServer& server_;
  grpc::Channel& channel_;
  const absl::Time others_deadline_ = absl::Now() + server_.start_time;  // for all attempts
  uintmax_t log_start_ = 0;
  pid_t pid_ = 0;
  std::optional<int> exit_status_;
};

}  // namespace

absl::StatusOr<LocalServer> FindLocalServer() {
  LocalServer server{.folder = StateFolder(), .socket = "", .program = Program()};
  if (absl::Status made = MakeFolder(server.folder); !made.ok()) return made;
  absl::StatusOr<std::string> socket = SocketIn(server.folder);
  if (!socket.ok()) return socket.status();
  server.socket = *std::move(socket);
  return server;
}

absl::StatusOr<std::shared_ptr<grpc::Channel>> ConnectToLocalServer(const LocalServer& server) {
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = OpenChannel(server.Address());
  if (!channel.ok() || Answers(**channel)) return channel;
  if (absl::Status started = Starter(server, **channel).Start(); !started.ok()) return started;
  return channel;
}

absl::StatusOr<std::shared_ptr<grpc::Channel>> ConnectIfRunning(const LocalServer& server) {
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = OpenChannel(server.Address());
  if (!channel.ok() || Answers(**channel)) return channel;
  return absl::UnavailableError(
      absl::StrCat("no private server is running (one is started when it is needed, and lives in ",
                   server.folder, ")"));
}

}  // namespace ballpiston::client
