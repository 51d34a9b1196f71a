#include "server/observability/log.h"

#include <unistd.h>

#include <atomic>
#include <string>

#include "absl/time/clock.h"
#include "server/observability/log_output.h"

namespace ballpiston::server {
namespace {

std::atomic<LogFormat> chosen_format = LogFormat::kText;
std::atomic<Severity> least_severity = Severity::kInfo;
std::atomic<bool> silent = false;

LogOutput& StandardError() {
  static auto* const output = new LogOutput(STDERR_FILENO);
  return *output;
}

std::string LossLine(int64_t lost) {
  return LogLine(chosen_format, absl::Now(), Severity::kWarning,
                 "lines were dropped: the log was not read",
                 {{"lines", static_cast<double>(lost)}});
}

}  // namespace

void SetLogOptions(const LogOptions& options) {
  chosen_format = options.format;
  least_severity = options.least;
  silent = options.silent;
}

void Log(Severity severity, absl::string_view message, LogFields fields) {
  if (silent || severity < least_severity.load(std::memory_order_relaxed)) return;
  StandardError().Write(LogLine(chosen_format, absl::Now(), severity, message, fields), LossLine);
}

}  // namespace ballpiston::server
