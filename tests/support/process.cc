#include "tests/support/process.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "tests/support/preamble.h"

namespace ballpiston {
namespace {

struct Pipe {
  int read = -1;
  int write = -1;
  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    read = ends[0];
    write = ends[1];
  }
};

// `setpriv` kills the program when this thread ends; `env` sets its signals and its environment.
std::vector<std::string> CommandLine(const ProcessOptions& options) {
  std::vector<std::string> words = {"setpriv", "--pdeathsig", "KILL", "env",
                                    "--default-signal=INT,HUP,TERM"};
  for (const auto& [name, value] : options.environment) {
    if (value.empty()) words.insert(words.begin() + 5, "--unset=" + name);
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

// Repeats a system call that a signal has interrupted.
template <typename Call>
auto Uninterrupted(Call call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

}  // namespace

Process::Process(const ProcessOptions& options) : closed_(eventfd(0, EFD_CLOEXEC)) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const Ends ends = options.on_terminal ? OpenTerminal(actions) : OpenPipes(actions);
  Start(options, actions);
  for (const int end : ends) close(end);
  for (Stream* stream : {&out_, &err_}) {
    stream->ended = stream->descriptor < 0;
    if (!stream->ended) stream->reader = std::thread([this, stream] { Read(*stream); });
  }
}

Process::Ends Process::OpenTerminal(posix_spawn_file_actions_t& actions) {
  char name[100];
  int end = -1;
  if (openpty(&out_.descriptor, &end, name, nullptr, nullptr) != 0) {
    throw std::runtime_error("no pseudo-terminal");
  }
  fcntl(out_.descriptor, F_SETFD, FD_CLOEXEC);
  // The first terminal that the leader of a session opens becomes the session's.
  posix_spawn_file_actions_addclose(&actions, end);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, name, O_RDWR, 0);
  posix_spawn_file_actions_adddup2(&actions, STDIN_FILENO, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, STDIN_FILENO, STDERR_FILENO);
  return {end};
}

Process::Ends Process::OpenPipes(posix_spawn_file_actions_t& actions) {
  const Pipe out, err;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.write, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.write, STDERR_FILENO);
  out_.descriptor = out.read;
  err_.descriptor = err.read;
  return {out.write, err.write};
}

void Process::Start(const ProcessOptions& options, posix_spawn_file_actions_t& actions) {
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, options.on_terminal ? POSIX_SPAWN_SETSID : 0);
  const std::vector<std::string> command = CommandLine(options);
  const int error = posix_spawnp(&pid_, command[0].c_str(), &actions, &attributes,
                                 Pointers(command).data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw std::runtime_error("cannot start " + options.command.at(0) +
                             " with setpriv: " + std::strerror(error));
  }
}

Process::~Process() {
  if (!waited_) {
    kill(pid_, SIGKILL);
    Wait();
  }
  close(closed_);
}

void Process::Read(Stream& stream) {
  char buffer[1 << 14];
  while (true) {
    pollfd events[] = {{stream.descriptor, POLLIN, 0}, {closed_, POLLIN, 0}};
    Uninterrupted([&] { return poll(events, std::size(events), -1); });
    // At the end of a terminal there is the error EIO.
    const ssize_t size = events[1].revents != 0 ? 0 : Uninterrupted([&] {
      return read(stream.descriptor, buffer, sizeof(buffer));
    });
    const std::lock_guard lock(mutex_);
    if (size > 0) stream.text.append(buffer, static_cast<size_t>(size));
    if (size <= 0) stream.ended = true;
    news_.notify_all();
    if (size <= 0) return;
  }
}

void Process::Close(Stream& stream) {
  if (!stream.reader.joinable()) return;
  stream.reader.join();
  close(stream.descriptor);
}

void Process::Type(const std::string& keys) const {
  if (write(out_.descriptor, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size())) {
    throw std::runtime_error("cannot type");
  }
}

void Process::CloseTerminal() {
  eventfd_write(closed_, 1);
  Close(out_);
}

void Process::Signal(int signal) const {
  if (!waited_) kill(pid_, signal);
}

std::string Process::Output() const {
  const std::lock_guard lock(mutex_);
  return out_.text + err_.text;
}

bool Process::WaitFor(const Stream& stream, const std::string& text) {
  std::unique_lock lock(mutex_);
  const auto found = [&] { return stream.text.find(text) != std::string::npos; };
  AwaitNotified(news_, lock, [&] { return found() || stream.ended; });
  return found();
}

std::string Process::WaitForErrLine(const std::function<bool(const std::string&)>& wanted) {
  std::unique_lock lock(mutex_);
  std::string line;
  size_t begin = 0;  // of the lines that follow
  const auto found = [&] {
    for (size_t end; (end = err_.text.find('\n', begin)) != std::string::npos; begin = end + 1) {
      line = err_.text.substr(begin, end - begin);
      if (wanted(line)) return true;
    }
    return false;
  };
  bool is_found = false;
  AwaitNotified(news_, lock, [&] { return (is_found = found()) || err_.ended; });
  return is_found ? line : "";
}

bool Process::EndsWithin(std::chrono::milliseconds time) const {
  if (waited_) return true;
  pollfd end{static_cast<int>(syscall(SYS_pidfd_open, pid_, 0)), POLLIN, 0};
  if (end.fd < 0) throw std::runtime_error("pidfd_open failed");
  const bool ended =
      Uninterrupted([&] { return poll(&end, 1, static_cast<int>(time.count())); }) > 0;
  close(end.fd);
  return ended;
}

ProcessResult Process::Wait() {
  if (!waited_) {
    if (!EndsWithin(kPatience)) {
      throw std::runtime_error("the program still runs after 15 minutes; its output:\n" + Output());
    }
    int status = 0;
    if (Uninterrupted([&] { return waitpid(pid_, &status, 0); }) != pid_) {
      throw std::runtime_error("waitpid failed");
    }
    exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    waited_ = true;
    for (Stream* stream : {&out_, &err_}) {
      {
        // A program that this one started may keep the stream open.
        std::unique_lock lock(mutex_);
        AwaitNotified(news_, lock, [&] { return stream->ended; });
      }
      Close(*stream);
    }
  }
  const std::lock_guard lock(mutex_);
  return {exit_code_, out_.text, err_.text};
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
