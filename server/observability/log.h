// The server's log: one line per message (log_line.h), on standard error. If nobody reads the log,
// the server goes on (log_output.h). Thread-safe.
//
//   Log(Severity::kInfo, "job accepted", {{"job", name}, {"principal", caller.name}});
//
// Never log a token, a key or another secret.
#pragma once

#include "absl/strings/string_view.h"
#include "server/observability/log_line.h"

namespace ballpiston::server {

struct LogOptions {
  LogFormat format = LogFormat::kText;
  Severity least = Severity::kInfo;  // less severe messages are not written
  bool silent = false;               // nothing is written; for tests with thousands of errors
};

// Applies to the whole process from now on.
void SetLogOptions(const LogOptions& options);

void Log(Severity severity, absl::string_view message, LogFields fields = {});

inline void LogInfo(absl::string_view message) { Log(Severity::kInfo, message); }
inline void LogError(absl::string_view message) { Log(Severity::kError, message); }

}  // namespace ballpiston::server
