#include "client/library/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::client {
namespace {

void SetFiles(const ChildProcess& child, posix_spawn_file_actions_t* actions) {
  posix_spawn_file_actions_addopen(actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  if (!child.output.empty()) {
    posix_spawn_file_actions_addopen(actions, STDOUT_FILENO, child.output.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0600);
    posix_spawn_file_actions_adddup2(actions, STDOUT_FILENO, STDERR_FILENO);
  }
  if (!child.folder.empty()) posix_spawn_file_actions_addchdir_np(actions, child.folder.c_str());
  posix_spawn_file_actions_addclosefrom_np(actions, STDERR_FILENO + 1);
}

void SetSignalsAndGroup(const ChildProcess& child, posix_spawnattr_t* attributes) {
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(attributes, &signals);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGXFSZ, SIGCHLD}) sigaddset(&signals, signal);
  posix_spawnattr_setsigdefault(attributes, &signals);
  int flags = POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF;
  if (child.detached) flags |= POSIX_SPAWN_SETSID;
  if (child.own_group) flags |= POSIX_SPAWN_SETPGROUP;  // pgroup 0, the default: a new group
  posix_spawnattr_setflags(attributes, static_cast<short>(flags));
}

std::vector<char*> Arguments(const ChildProcess& child) {
  std::vector<char*> arguments;
  for (const std::string& word : child.command)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  return arguments;
}

// This program's variables except one.
std::vector<char*> Environment(const std::string& without) {
  std::vector<char*> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!absl::StartsWith(*variable, without + "=")) variables.push_back(*variable);
  }
  variables.push_back(nullptr);
  return variables;
}

int Decode(int status) {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

std::string ProgramBeside(const std::string& name) {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).replace_filename(name);
}

absl::StatusOr<pid_t> StartChild(const ChildProcess& child) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  SetFiles(child, &actions);
  SetSignalsAndGroup(child, &attributes);
  pid_t pid = 0;
  const int error = posix_spawnp(&pid, child.command[0].c_str(), &actions, &attributes,
                                 Arguments(child).data(), Environment(child.without).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error == 0) return pid;
  return absl::ErrnoToStatus(error, absl::StrCat("cannot start ", child.command[0]));
}

std::optional<int> ExitStatus(pid_t pid) {
  int status = 0;
  const pid_t ended = waitpid(pid, &status, WNOHANG);
  if (ended < 0 && errno == ECHILD) return kUnknownStatus;
  if (ended != pid) return std::nullopt;
  return Decode(status);
}

absl::StatusOr<int> WaitForChild(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0) {
    if (errno == ECHILD) return kUnknownStatus;
    if (errno != EINTR) return absl::ErrnoToStatus(errno, "waiting for a child process");
  }
  return Decode(status);
}

absl::StatusOr<int> RunChild(const ChildProcess& child) {
  const absl::StatusOr<pid_t> pid = StartChild(child);
  return pid.ok() ? WaitForChild(*pid) : pid.status();
}

}  // namespace ballpiston::client
