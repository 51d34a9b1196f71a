#include "tests/support/terminal_process.h"

#include <poll.h>
#include <pty.h>
#include <sys/wait.h>

#include <cerrno>

#include "tests/support/preamble.h"

namespace ballpiston {
namespace {

// The command is setpriv, env and the program. env changes the environment, so that the child calls
// only signal and exec after fork.
std::vector<std::string> CommandOf(const ProcessOptions& options) {
  std::vector<std::string> command = {"setpriv", "--pdeathsig", "KILL", "env"};
  for (const auto& [name, value] : options.environment) {
    if (value.empty()) command.insert(command.end(), {"-u", name});
  }
  command.push_back("TERM=xterm");
  for (const auto& [name, value] : options.environment) {
    if (!value.empty()) command.push_back(name + "=" + value);
  }
  command.insert(command.end(), options.command.begin(), options.command.end());
  return command;
}

}  // namespace

TerminalProcess::TerminalProcess(const ProcessOptions& options) {
  const std::vector<std::string> command = CommandOf(options);
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
  if (pid_ < 0) throw std::runtime_error("no pseudo-terminal");
  if (pid_ > 0) return;
  for (const int ended_by : {SIGINT, SIGHUP, SIGTERM}) signal(ended_by, SIG_DFL);
  execvp(words[0], words.data());
  _exit(127);
}

TerminalProcess::~TerminalProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  CloseTerminal();
}

bool TerminalProcess::Read() {
  AwaitThat([this] {
    pollfd readable{terminal_, POLLIN, 0};
    return poll(&readable, 1, 0) != 0;
  });
  char buffer[4096];
  ssize_t size = -1;
  do {
    size = read(terminal_, buffer, sizeof(buffer));
  } while (size < 0 && errno == EINTR);
  if (size <= 0) return false;  // EIO: no process has the terminal any more
  output_.append(buffer, static_cast<size_t>(size));
  return true;
}

bool TerminalProcess::WaitFor(const std::string& text) {
  while (output_.find(text) == std::string::npos) {
    if (!Read()) return false;
  }
  return true;
}

void TerminalProcess::Type(const std::string& keys) {
  if (write(terminal_, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size())) {
    throw std::runtime_error("cannot type");
  }
}

void TerminalProcess::CloseTerminal() {
  if (terminal_ >= 0) close(terminal_);
  terminal_ = -1;
}

TerminalProcess::Outcome TerminalProcess::Wait() {
  while (terminal_ >= 0 && Read()) {
  }
  int status = 0;
  AwaitThat([&] { return waitpid(pid_, &status, WNOHANG) != 0; });
  pid_ = 0;
  return {WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), output_};
}

}  // namespace ballpiston
