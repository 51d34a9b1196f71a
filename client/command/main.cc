#include <csignal>
#include <cstdlib>
#include <iostream>

#include "client/command/command_line.h"
#include "client/command/interrupts.h"
#include "client/output/progress_reporter.h"
#include "client/output/standard_output.h"

namespace {

// See https://no-color.org.
bool HasColour() {
  const char* const refused = std::getenv("NO_COLOR");
  if (refused != nullptr && refused[0] != '\0') return false;
  return ballpiston::client::HasTerminal();
}

}  // namespace

// A closed pipe and a limit on files' sizes make a write fail (standard_output.h); no signal ends
// the program.
int main(int argc, char** argv) {
  using ballpiston::client::ExitCode;
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
}
