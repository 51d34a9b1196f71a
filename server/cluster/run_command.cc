#include "server/cluster/run_command.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <thread>

#include "absl/cleanup/cleanup.h"
#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kMostOutput = size_t{64} << 20;
constexpr std::chrono::milliseconds kLook(5);  // between two looks at the program

// A file in memory: the standard output of the program, or its standard error.
class MemoryFile {
 public:
  MemoryFile() : number_(memfd_create("", MFD_CLOEXEC)) {}
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(number_); }

  int number() const { return number_; }  // negative: it could not be created

  std::string Contents() const {
    struct stat status {};
    fstat(number_, &status);
    std::string text(std::min(static_cast<size_t>(status.st_size), kMostOutput), '\0');
    const ssize_t size = pread(number_, text.data(), text.size(), 0);
    text.resize(static_cast<size_t>(std::max(size, ssize_t{0})));
    return text;
  }

 private:
  const int number_;
};

std::vector<char*> Pointers(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

// The server blocks and ignores some signals. The program gets the default settings.
absl::StatusOr<pid_t> Start(const Command& command, const MemoryFile& out, const MemoryFile& err) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  const absl::Cleanup destroy = [&] {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  };
  posix_spawn_file_actions_adddup2(&files, out.number(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, err.number(), STDERR_FILENO);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  const sigset_t none = {};
  sigset_t all;
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  pid_t pid = 0;
  const std::vector<char*> words = Pointers(command.words);
  const std::vector<char*> environment = Pointers(command.environment);
  const int error =
      posix_spawnp(&pid, words[0], &files, &attributes, words.data(), environment.data());
  if (error == 0) return pid;
  const std::string why = absl::StrCat(command.words[0], ": ", std::strerror(error));
  return error == ENOENT ? absl::NotFoundError(why) : absl::UnavailableError(why);
}

// The exit code as in CommandOutput; or an error, and the program is killed.
absl::StatusOr<int> AwaitExitCode(pid_t pid, const Command& command, const std::stop_token& stop) {
  const Clock::time_point end = Clock::now() + command.limit;
  int status = 0;
  while (waitpid(pid, &status, WNOHANG) != pid) {
    const bool is_stopped = stop.stop_requested();
    if (!is_stopped && Clock::now() < end) {
      std::this_thread::sleep_for(kLook);
      continue;
    }
    kill(pid, SIGKILL);
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) continue;
    if (is_stopped) return absl::CancelledError("stopped");
    return absl::DeadlineExceededError(
        absl::StrCat(command.words[0], " did not end within ", command.limit.count() / 1000, " s"));
  }
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

absl::StatusOr<CommandOutput> RunCommand(const Command& command, const std::stop_token& stop) {
  const MemoryFile out, err;
  if (out.number() < 0 || err.number() < 0) {
    return absl::UnavailableError("cannot create a file in memory for the program's output");
  }
  const absl::StatusOr<pid_t> pid = Start(command, out, err);
  if (!pid.ok()) return pid.status();
  const absl::StatusOr<int> exit_code = AwaitExitCode(*pid, command, stop);
  if (!exit_code.ok()) return exit_code.status();
  return CommandOutput{*exit_code, out.Contents(), err.Contents()};
}

}  // namespace ballpiston::server
