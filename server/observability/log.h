// What the server tells its operator: one line each (log_line.h), on standard error. One that
// nobody reads stops nothing (log_output.h). Thread-safe.
//
//   Log(Severity::kInfo, "job accepted", {{"job", name}, {"principal", caller.name}});
//
// Never a token, a key, or what else lets one in.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_LOG_H_
#define BALLPISTON_SERVER_OBSERVABILITY_LOG_H_

#include "absl/strings/string_view.h"
#include "server/observability/log_line.h"

namespace ballpiston::server {

struct LogOptions {
  LogFormat format = LogFormat::kText;
  Severity least = Severity::kInfo;  // what is less severe is not written
  bool silent = false;               // nothing is: for tests of what fails a thousand times
};

// From now on, for the whole process.
void SetLogOptions(const LogOptions& options);

void Log(Severity severity, absl::string_view message, LogFields fields = {});

inline void LogInfo(absl::string_view message) { Log(Severity::kInfo, message); }
inline void LogError(absl::string_view message) { Log(Severity::kError, message); }

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_LOG_H_
