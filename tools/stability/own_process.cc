#include "tools/stability/own_process.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <type_traits>

namespace ballpiston::stability {
namespace {

static_assert(std::is_trivially_copyable_v<Failures>, "it is sent as bytes");

// A message this short is written at once.
[[noreturn]] void ComputeAndSend(const std::function<Failures()>& compute, unsigned seconds,
                                 int pipe) {
  const rlimit limit = {.rlim_cur = seconds, .rlim_max = seconds};
  setrlimit(RLIMIT_CPU, &limit);
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

void WaitFor(pid_t process) {
  while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace

std::optional<Failures> InOwnProcess(const std::function<Failures()>& compute, unsigned seconds) {
  int ends[2];
  if (pipe(ends) != 0) return std::nullopt;
  const pid_t process = fork();
  if (process == 0) ComputeAndSend(compute, seconds, ends[1]);
  close(ends[1]);
  const std::optional<Failures> failures = process < 0 ? std::nullopt : Received(ends[0]);
  close(ends[0]);
  if (process > 0) WaitFor(process);
  return failures;
}

}  // namespace ballpiston::stability
