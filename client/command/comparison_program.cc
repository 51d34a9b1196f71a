#include "client/command/comparison_program.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "client/library/child_process.h"

namespace ballpiston::client {
namespace {

// Until the other end is closed. Takes the descriptor over.
void ReadLines(int descriptor, const std::function<void(const std::string&)>& take) {
  FILE* const file = fdopen(descriptor, "r");
  char* line = nullptr;
  size_t room = 0;
  for (ssize_t length; (length = getline(&line, &room, file)) > 0;) {
    take(std::string(line, static_cast<size_t>(length)));
  }
  std::free(line);
  std::fclose(file);
}

absl::StatusOr<int> RunReading(const ChildProcess& child, int read_end, Interrupts& interrupts,
                               const std::function<void(const std::string&)>& take) {
  const absl::StatusOr<pid_t> pid = StartChild(child);
  close(child.standard_output);
  if (pid.ok()) {
    const auto end = [pid] { kill(*pid, SIGINT); };
    const Interrupts::Scope scope(interrupts, {end, end, [] {}});
    ReadLines(read_end, take);
  } else {
    close(read_end);
  }
  return pid.ok() ? WaitForChild(*pid) : pid.status();
}

}  // namespace

absl::StatusOr<int> RunComparisonProgram(std::vector<std::string> flags, Interrupts& interrupts,
                                         const std::function<void(const std::string&)>& take) {
  const std::string program = ProgramBeside(kComparisonProgram);
  if (access(program.c_str(), X_OK) != 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("the program that measures this figure is missing: ", program));
  }
  flags.insert(flags.begin(), program);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return absl::ErrnoToStatus(errno, "cannot make a pipe");
  return RunReading(
      {.command = std::move(flags), .folder = "", .output = "", .standard_output = ends[1]},
      ends[0], interrupts, take);
}

}  // namespace ballpiston::client
