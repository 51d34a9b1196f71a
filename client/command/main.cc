#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <system_error>

#include "absl/status/status.h"
#include "client/command/command_line.h"
#include "client/command/interrupts.h"
#include "client/output/output_file.h"
#include "client/output/progress.h"

using ballpiston::client::ExitCode;

namespace {

// See https://no-color.org.
bool HasColour() {
  const char* const refused = std::getenv("NO_COLOR");
  if (refused != nullptr && refused[0] != '\0') return false;
  return ballpiston::client::HasTerminal();
}

// A file with the number of a closed standard file would receive the messages. Standard output is
// opened for reading: writing to it stays an error.
void OpenStandardFiles() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(file, F_GETFD) >= 0) continue;
    open("/dev/null", file == STDOUT_FILENO ? O_RDONLY : O_RDWR);
  }
}

}  // namespace

// A closed pipe and a limit on files' sizes make a write fail (output_file.h); no signal ends
// the program.
int main(int argc, char** argv) try {
  OpenStandardFiles();
  std::signal(SIGCHLD, SIG_DFL);  // where it is ignored, the exit status of a child is lost
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  setenv("GRPC_VERBOSITY", "NONE", 0);  // this program prints the errors itself
  ballpiston::client::ListenForInterrupts();
  ballpiston::client::FileStream out(STDOUT_FILENO);
  ballpiston::client::Terminal terminal{.out = out, .err = std::cerr};
  terminal.colour = HasColour();
  const ExitCode code = ballpiston::client::RunCommandLine({argv + 1, argv + argc}, terminal);
  const int error = out.Finish();
  // A reader may close the pipe (`ballpiston result JOB | head`).
  if (error == 0 || error == EPIPE) return static_cast<int>(code);
  std::cerr << "ballpiston: "
            << absl::ErrnoToStatus(error, "cannot write standard output").message() << '\n';
  return static_cast<int>(
      ExitCode::kUsage);  // as for a file that cannot be written (output_file.h)
} catch (const std::system_error& error) {
  if (error.code() != std::errc::resource_unavailable_try_again) throw;
  std::cerr << "ballpiston: cannot start a thread: retry later, or raise the limit of processes "
               "(ulimit -u)\n";
  return static_cast<int>(ExitCode::kUnreachable);
}
