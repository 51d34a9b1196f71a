// The flags of ballpistond, on its command line and in the file of --config.
#pragma once

#include <chrono>
#include <string>

#include "absl/status/statusor.h"
#include "server/ballpiston_server.h"
#include "server/status/log.h"

namespace ballpiston::server {

struct CommandLine {
  ServerOptions server;
  Severity log_level = Severity::kInfo;    // less severe messages are not logged
  std::chrono::milliseconds idle_exit{0};  // 0: never
  std::chrono::milliseconds drain{10'000};

  // At most one of these is set. The program then executes this command and starts no server.
  std::string page;       // the text that --help or --version prints
  std::string new_token;  // PRINCIPAL:ROLE[:DAYS]
  bool check = false;
  std::string backup;  // the file to write
};

// INVALID_ARGUMENT names the flag, its value and the permitted values, and of a wrong line of the
// file of --config also the file and the line.
absl::StatusOr<CommandLine> ParseCommandLine(int argc, const char* const* argv);

}  // namespace ballpiston::server
