// The whole program: parses the command line, acts, says what went wrong, returns the exit code.
#ifndef BALLPISTON_CLIENT_COMMAND_COMMAND_LINE_H_
#define BALLPISTON_CLIENT_COMMAND_COMMAND_LINE_H_

#include "client/command/exit_code.h"
#include "client/command/verbs.h"

namespace ballpiston::client {

// Errors of the command line are kUsage with what to do; --help is kDone. Silences Protocol
// Buffers' own log for the rest of the process.
ExitCode RunCommandLine(int argc, const char* const* argv, Terminal& terminal);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_COMMAND_LINE_H_
