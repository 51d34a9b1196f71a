#include "server/observability/log.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <mutex>
#include <string>

#include "absl/time/clock.h"

namespace ballpiston::server {
namespace {

std::atomic<LogFormat> chosen_format = LogFormat::kText;
std::atomic<Severity> least_severity = Severity::kInfo;
std::atomic<bool> silent = false;

// A line that standard error takes in pieces must not be mixed with another. What it does not take
// at all (it is closed, or its disk is full) is lost: the server goes on.
void Write(absl::string_view line) {
  static auto* const one_at_a_time = new std::mutex;
  std::lock_guard lock(*one_at_a_time);
  while (!line.empty()) {
    const ssize_t written = write(STDERR_FILENO, line.data(), line.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    line.remove_prefix(static_cast<size_t>(written));
  }
}

}  // namespace

void SetLogOptions(const LogOptions& options) {
  chosen_format = options.format;
  least_severity = options.least;
  silent = options.silent;
}

void Log(Severity severity, absl::string_view message, LogFields fields) {
  if (silent || severity < least_severity.load(std::memory_order_relaxed)) return;
  Write(LogLine(chosen_format, absl::Now(), severity, message, fields));
}

}  // namespace ballpiston::server
