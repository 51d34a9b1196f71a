#include "tests/support/process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>

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

std::vector<std::string> Environment(const std::map<std::string, std::string>& changes) {
  std::vector<std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string variable = *entry;
    if (changes.count(variable.substr(0, variable.find('='))) == 0) variables.push_back(variable);
  }
  for (const auto& [name, value] : changes) {
    if (!value.empty()) variables.push_back(name + "=" + value);
  }
  return variables;
}

std::vector<char*> Pointers(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

// Writes until the text or the reader ends.
void WriteAll(int descriptor, const std::string& text) {
  sigset_t pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe, nullptr);  // of this thread, which writes nothing else
  size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = write(descriptor, text.data() + written, text.size() - written);
    if (n <= 0) break;
    written += static_cast<size_t>(n);
  }
  close(descriptor);
}

sigset_t SignalsThatEndPrograms() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGHUP, SIGTERM}) sigaddset(&signals, signal);
  return signals;
}

// Repeats a system call that a signal has interrupted.
template <typename Call>
auto Uninterrupted(Call call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

}  // namespace

Process::Process(const ProcessOptions& options) {
  const Pipe in, out, err;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.read, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.write, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.write, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  const sigset_t signals = SignalsThatEndPrograms();
  posix_spawnattr_setsigdefault(&attributes, &signals);
  const std::vector<std::string> environment = Environment(options.environment);
  std::vector<std::string> command = {"setpriv", "--pdeathsig", "KILL"};
  command.insert(command.end(), options.command.begin(), options.command.end());
  const int error = posix_spawnp(&pid_, command[0].c_str(), &actions, &attributes,
                                 Pointers(command).data(), Pointers(environment).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  for (const int end : {in.read, out.write, err.write}) close(end);
  if (error != 0) {
    throw std::runtime_error("cannot start " + options.command.at(0) +
                             " with setpriv: " + std::strerror(error));
  }
  writer_ = std::thread([input = options.input, end = in.write] { WriteAll(end, input); });
  out_.descriptor = out.read;
  err_.descriptor = err.read;
  for (Stream* stream : {&out_, &err_}) {
    stream->reader = std::thread([this, stream] { Read(*stream); });
  }
}

Process::~Process() {
  if (!waited_) {
    kill(pid_, SIGKILL);
    Wait();
  }
}

void Process::Read(Stream& stream) {
  char buffer[1 << 14];
  while (true) {
    const ssize_t size = read(stream.descriptor, buffer, sizeof(buffer));
    const std::lock_guard lock(mutex_);
    if (size > 0) stream.text.append(buffer, static_cast<size_t>(size));
    if (size <= 0) stream.ended = true;
    news_.notify_all();
    if (size <= 0) return;
  }
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
    writer_.join();
    for (Stream* stream : {&out_, &err_}) {
      {
        // A program that this one started may keep the stream open.
        std::unique_lock lock(mutex_);
        AwaitNotified(news_, lock, [&] { return stream->ended; });
      }
      stream->reader.join();
      close(stream->descriptor);
    }
  }
  const std::lock_guard lock(mutex_);
  return {exit_code_, out_.text, err_.text};
}

ProcessResult RunProgram(const ProcessOptions& options) { return Process(options).Wait(); }

double MiBOf(const std::string& process, const std::string& line) {
  std::ifstream status("/proc/" + process + "/status");
  for (std::string word; status >> word;) {
    double kib = 0;
    if (word == line && status >> kib) return kib / 1024;
  }
  return 0;
}

}  // namespace ballpiston
