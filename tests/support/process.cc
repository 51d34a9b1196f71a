#include "tests/support/process.h"

#include <fcntl.h>
#include <pty.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "tests/support/preamble.h"

namespace ballpiston {
namespace {

// `setpriv` kills the program when this thread ends; `setsid` makes its standard input the terminal
// of its session; `env` sets its signals and its environment.
std::vector<std::string> CommandLine(const ProcessOptions& options) {
  std::vector<std::string> words = {"setpriv", "--pdeathsig", "KILL"};
  if (options.on_terminal) words.insert(words.end(), {"setsid", "--ctty"});
  words.insert(words.end(), {"env", "--default-signal=INT,HUP,TERM"});
  for (const auto& [name, value] : options.environment) {
    if (value.empty()) words.insert(words.end(), {"-u", name});
  }
  for (const auto& [name, value] : options.environment) {
    if (!value.empty()) words.push_back(name + "=" + value);
  }
  if (options.on_terminal) words.push_back("TERM=xterm");
  words.insert(words.end(), options.command.begin(), options.command.end());
  return words;
}

std::vector<char*> Pointers(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

std::string TextIn(int file) { return Contents(absl::StrCat("/proc/self/fd/", file)); }

}  // namespace

Process::Process(const ProcessOptions& options)
    : out_(memfd_create("out", MFD_CLOEXEC)), err_(memfd_create("err", MFD_CLOEXEC)) {
  int input = -1;
  if (options.on_terminal) {
    if (openpty(&terminal_, &input, nullptr, nullptr, nullptr) != 0) {
      throw std::runtime_error("no pseudo-terminal");
    }
    for (const int end : {terminal_, input}) fcntl(end, F_SETFD, FD_CLOEXEC);
    fcntl(terminal_, F_SETFL, O_NONBLOCK);
    Start(CommandLine(options), {input, input, input});
  } else {
    input = open("/dev/null", O_RDONLY | O_CLOEXEC);
    Start(CommandLine(options), {input, out_, err_});
  }
  close(input);
}

void Process::Start(const std::vector<std::string>& command, const std::array<int, 3>& streams) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  int standard = 0;
  for (const int stream : streams) {
    posix_spawn_file_actions_adddup2(&actions, stream, standard++);
  }
  const int error =
      posix_spawnp(&pid_, command[0].c_str(), &actions, nullptr, Pointers(command).data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error(std::string("no setpriv: ") + std::strerror(error));
}

Process::~Process() {
  Signal(SIGKILL);
  Wait();
  for (const int descriptor : {out_, err_, terminal_}) close(descriptor);
}

void Process::CloseTerminal() { close(std::exchange(terminal_, -1)); }

void Process::Type(const std::string& keys) const {
  if (write(terminal_, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size())) {
    throw std::runtime_error("cannot type");
  }
}

void Process::Signal(int signal) const {
  if (!exit_code_) kill(pid_, signal);
}

std::string Process::Output() const { return TextIn(out_) + TextIn(err_); }

// Also copies what is on the terminal. When it returns true, everything is copied.
bool Process::HasEnded() {
  int status = 0;
  if (!exit_code_ && waitpid(pid_, &status, WNOHANG) == pid_) {
    exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }
  char buffer[1 << 12];
  for (ssize_t size; (size = read(terminal_, buffer, sizeof(buffer))) > 0;) {
    if (write(out_, buffer, static_cast<size_t>(size)) != size) throw std::runtime_error("no room");
  }
  return exit_code_.has_value();
}

bool Process::WaitFor(int stream, const std::string& text) {
  const auto found = [&] { return absl::StrContains(TextIn(stream), text); };
  AwaitThat([&] { return HasEnded() || found(); });
  return found();
}

std::string Process::WaitForErrLine(const std::function<bool(const std::string&)>& wanted) {
  std::string line;
  const auto found = [&] {
    std::vector<std::string> lines = absl::StrSplit(TextIn(err_), '\n');
    lines.pop_back();  // not yet a line
    const auto first = std::find_if(lines.begin(), lines.end(), wanted);
    if (first != lines.end()) line = *first;
    return first != lines.end();
  };
  AwaitThat([&] { return HasEnded() || found(); });
  return found() ? line : "";
}

bool Process::EndsWithin(std::chrono::milliseconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  AwaitThat([&] { return HasEnded() || std::chrono::steady_clock::now() >= end; });
  return exit_code_.has_value();
}

ProcessResult Process::Wait() {
  if (!EndsWithin(kPatience)) {
    throw std::runtime_error("the program still runs after 15 minutes; its output:\n" + Output());
  }
  return {*exit_code_, TextIn(out_), TextIn(err_)};
}

ProcessResult RunProgram(const ProcessOptions& options) { return Process(options).Wait(); }

std::vector<pid_t> ProcessesWith(const std::string& text) {
  std::vector<pid_t> found;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", gone)) {
    const pid_t process = std::atoi(entry.path().filename().c_str());  // 0: no process
    if (process == 0) continue;
    if (absl::StrContains(Contents(entry.path() / "cmdline"), text)) found.push_back(process);
  }
  return found;
}

double MiBOf(const std::string& process, const std::string& line) {
  std::ifstream status("/proc/" + process + "/status");
  for (std::string word; status >> word;) {
    double kib = 0;
    if (word == line && status >> kib) return kib / 1024;
  }
  return 0;
}

}  // namespace ballpiston
