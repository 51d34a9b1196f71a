#include <csignal>
#include <cstdlib>
#include <iostream>

#include "client/command/command_line.h"
#include "client/output/standard_output.h"

// A closed pipe shows as a failed write (standard_output.h), not as a signal.
int main(int argc, char** argv) {
  using ballpiston::client::ExitCode;
  std::signal(SIGPIPE, SIG_IGN);
  setenv("GRPC_VERBOSITY", "NONE", 0);  // what went wrong is told here, in the project's words
  ballpiston::client::StandardOutput out;
  ballpiston::client::Terminal terminal{out, std::cerr};
  const ExitCode code = ballpiston::client::RunCommandLine(argc, argv, terminal);
  const absl::Status written = out.Finish();
  if (written.ok()) return static_cast<int>(code);
  std::cerr << "ballpiston: " << written.message() << '\n';
  return static_cast<int>(ExitCode::kFailed);
}
