// The flags of ballpistond.
#ifndef BALLPISTON_SERVER_COMMAND_LINE_H_
#define BALLPISTON_SERVER_COMMAND_LINE_H_

#include <chrono>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "server/ballpiston_server.h"
#include "server/observability/log.h"
#include "server/security/new_token.h"

namespace ballpiston::server {

struct CommandLine {
  ServerOptions server;
  LogOptions log;
  std::optional<std::chrono::milliseconds> idle_exit;
  std::chrono::milliseconds drain{0};

  // Each instead of a server:
  std::optional<TokenRequest> new_token;
  bool check = false;
  std::string backup;  // where to; empty: no
};

// Ends the program on --help, --version, and (with exit code 2) on flags that do not exist.
// INVALID_ARGUMENT names the flag, its value and what is permitted.
absl::StatusOr<CommandLine> ParseCommandLine(int argc, char** argv);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_COMMAND_LINE_H_
