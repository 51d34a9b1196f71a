#include "tools/stability/own_process.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "absl/strings/str_cat.h"

namespace ballpiston::stability {
namespace {

static_assert(std::is_trivially_copyable_v<Failures>, "it is sent as bytes");

[[noreturn]] void Fail(const char* call) {
  throw std::runtime_error(absl::StrCat(call, ": ", std::strerror(errno)));
}

// The soft limit sends SIGXCPU. A hard limit of the same value would send SIGKILL, which the system
// also sends if there is no memory left.
bool LimitProcessorTime(unsigned seconds) {
  const rlimit limit = {.rlim_cur = seconds, .rlim_max = rlim_t{seconds} + 1};
  return std::signal(SIGXCPU, SIG_DFL) != SIG_ERR && setrlimit(RLIMIT_CPU, &limit) == 0;
}

// The message is so short that a single write sends it. An exception of `compute` must not reach
// the forked copy of the caller: noexcept turns it into a crash.
[[noreturn]] void ComputeAndSend(const std::function<Failures()>& compute, unsigned seconds,
                                 int pipe) noexcept {
  if (!LimitProcessorTime(seconds)) {
    std::perror("stability: cannot limit the processor time");
    _exit(EXIT_FAILURE);
  }
  const Failures failures = compute();
  const ssize_t sent = write(pipe, &failures, sizeof failures);
  _exit(sent == sizeof failures ? EXIT_SUCCESS : EXIT_FAILURE);
}

std::optional<Failures> Received(int pipe) {
  Failures failures;
  ssize_t got = 0;
  do {
    got = read(pipe, &failures, sizeof failures);
  } while (got < 0 && errno == EINTR);
  if (got != sizeof failures) return std::nullopt;
  return failures;
}

int StatusAtEnd(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) Fail("waitpid");
  }
  return status;
}

std::optional<Failures> ResultOf(int status, const std::optional<Failures>& received) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return std::nullopt;
  if (WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS && received) return received;
  throw std::runtime_error(
      absl::StrCat("a computation in a process of its own ended without a result, by ",
                   WIFSIGNALED(status) ? absl::StrCat("signal ", WTERMSIG(status))
                                       : absl::StrCat("exit status ", WEXITSTATUS(status))));
}

}  // namespace

std::optional<Failures> InOwnProcess(const std::function<Failures()>& compute, unsigned seconds) {
  int ends[2];
  if (pipe(ends) != 0) Fail("pipe");
  const pid_t process = fork();
  if (process < 0) Fail("fork");
  if (process == 0) ComputeAndSend(compute, seconds, ends[1]);
  close(ends[1]);
  const std::optional<Failures> received = Received(ends[0]);
  close(ends[0]);
  return ResultOf(StatusAtEnd(process), received);
}

}  // namespace ballpiston::stability
