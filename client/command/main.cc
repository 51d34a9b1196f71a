#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <system_error>

#include "client/command/command_line.h"
#include "client/command/interrupts.h"
#include "client/output/progress_reporter.h"
#include "client/output/standard_output.h"

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

// A closed pipe and a limit on files' sizes make a write fail (standard_output.h); no signal ends
// the program.
int main(int argc, char** argv) try {
  OpenStandardFiles();
  std::signal(SIGCHLD, SIG_DFL);  // where it is ignored, the exit status of a child is lost
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  setenv("GRPC_VERBOSITY", "NONE", 0);  // this program prints the errors itself
  ballpiston::client::Interrupts interrupts;
  ballpiston::client::StandardOutput out;
  ballpiston::client::Terminal terminal{.out = out, .err = std::cerr, .interrupts = &interrupts};
  terminal.colour = HasColour();
  const ExitCode code = ballpiston::client::RunCommandLine({argv + 1, argv + argc}, terminal);
  const absl::Status written = out.Finish();
  if (written.ok()) return static_cast<int>(code);
  std::cerr << "ballpiston: " << written.message() << '\n';
  return static_cast<int>(ExitCode::kUsage);  // as for a file that cannot be written (new_file.h)
} catch (const std::system_error& error) {
  if (error.code() != std::errc::resource_unavailable_try_again) throw;
  std::cerr << "ballpiston: cannot start a thread: retry later, or raise the limit of processes "
               "(ulimit -u)\n";
  return static_cast<int>(ExitCode::kUnreachable);
}
