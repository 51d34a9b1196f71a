#include "server/cluster/run_command.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <thread>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kMostOutput = size_t{64} << 20;
constexpr std::chrono::milliseconds kLook(50);  // between two checks of the stop token
// Usually a program ends immediately after it has closed its output.
constexpr std::chrono::milliseconds kPause(1);

class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { Close(); }

  int number() const { return number_; }
  bool open() const { return number_ >= 0; }
  void Close() {
    if (open()) close(std::exchange(number_, -1));
  }

 private:
  int number_;
};

struct Pipe {
  Descriptor read, write;
};

absl::StatusOr<Pipe> NewPipe() {
  std::array<int, 2> ends;
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    return absl::UnavailableError(absl::StrCat("no pipe: ", std::strerror(errno)));
  }
  return Pipe{Descriptor(ends[0]), Descriptor(ends[1])};
}

std::vector<char*> Pointers(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

// The server blocks and ignores some signals. The program gets the default settings.
absl::StatusOr<pid_t> Start(const Command& command, const Pipe& in, const Pipe& out,
                            const Pipe& err) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  const absl::Cleanup destroy = [&] {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  };
  posix_spawn_file_actions_adddup2(&files, in.read.number(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, out.write.number(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, err.write.number(), STDERR_FILENO);
  sigset_t none, all;
  sigemptyset(&none);
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

// Reads the available output. Closes the descriptor at its end.
void ReadInto(std::string& text, Descriptor& from) {
  std::array<char, 65536> buffer;
  const ssize_t n = read(from.number(), buffer.data(), buffer.size());
  if (n > 0 && text.size() < kMostOutput) text.append(buffer.data(), static_cast<size_t>(n));
  if (n == 0 || (n < 0 && errno != EINTR && errno != EAGAIN)) from.Close();
}

// Whether a program may go on. Not OK: the program must be killed.
class Bounds {
 public:
  Bounds(const Command& command, const std::stop_token& stop)
      : command_(command), stop_(stop), end_(Clock::now() + command.limit) {}

  absl::Status Check() const {
    if (stop_.stop_requested()) return absl::CancelledError("stopped");
    if (Clock::now() < end_) return absl::OkStatus();
    return absl::DeadlineExceededError(absl::StrCat(command_.words[0], " did not end within ",
                                                    command_.limit.count() / 1000, " s"));
  }

 private:
  const Command& command_;
  const std::stop_token& stop_;
  const Clock::time_point end_;
};

// Reads both outputs until they are closed.
absl::Status Collect(const Bounds& bounds, Descriptor& out, Descriptor& err,
                     CommandOutput& result) {
  while (out.open() || err.open()) {
    const absl::Status status = bounds.Check();
    if (!status.ok()) return status;
    std::array<pollfd, 2> polled = {pollfd{out.number(), POLLIN, 0},
                                    pollfd{err.number(), POLLIN, 0}};
    if (poll(polled.data(), polled.size(), static_cast<int>(kLook.count())) <= 0) continue;
    if (polled[0].revents != 0) ReadInto(result.output, out);
    if (polled[1].revents != 0) ReadInto(result.errors, err);
  }
  return absl::OkStatus();
}

// Waits for the end of a program, which may go on after it has closed its output.
absl::Status AwaitEnd(pid_t pid, const Bounds& bounds) {
  while (true) {
    siginfo_t ended = {};
    const int waited = waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOHANG | WNOWAIT);
    if (waited == 0 && ended.si_pid == pid) return absl::OkStatus();
    const absl::Status status = bounds.Check();
    if (!status.ok()) return status;
    std::this_thread::sleep_for(kPause);
  }
}

int ExitCodeOf(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) continue;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

absl::StatusOr<CommandOutput> RunCommand(const Command& command, const std::stop_token& stop) {
  absl::StatusOr<Pipe> in = NewPipe(), out = NewPipe(), err = NewPipe();
  for (const auto* pipe : {&in, &out, &err}) {
    if (!pipe->ok()) return pipe->status();
  }
  // Fits into an empty pipe, which holds 64 KiB.
  const size_t bytes = std::min<size_t>(command.input.size(), 65536);
  if (write(in->write.number(), command.input.data(), bytes) != static_cast<ssize_t>(bytes)) {
    return absl::UnavailableError("a pipe cannot be written");
  }
  in->write.Close();
  const absl::StatusOr<pid_t> pid = Start(command, *in, *out, *err);
  if (!pid.ok()) return pid.status();
  in->read.Close();
  out->write.Close();
  err->write.Close();
  CommandOutput result;
  const Bounds bounds(command, stop);
  absl::Status ended = Collect(bounds, out->read, err->read, result);
  if (ended.ok()) ended = AwaitEnd(*pid, bounds);
  if (!ended.ok()) kill(*pid, SIGKILL);
  result.exit_code = ExitCodeOf(*pid);
  if (!ended.ok()) return ended;
  return result;
}

}  // namespace ballpiston::server
