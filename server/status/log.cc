#include "server/status/log.h"

#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>

#include "absl/strings/escaping.h"
#include "absl/strings/str_replace.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "server/mutex.h"

namespace ballpiston::server {
namespace {

constexpr size_t kMaxMessage = 1500;
constexpr size_t kMaxValue = 160;
constexpr int kPatienceMilliseconds = 100;

std::atomic<Severity> least_severity = Severity::kInfo;

Mutex mutex;
int64_t dropped ABSL_GUARDED_BY(mutex) = 0;  // lines since the last one that was written

// Bytes that are not printable ASCII, quotes and backslashes become escape sequences.
std::string Escaped(absl::string_view text, size_t most) {
  std::string escaped =
      absl::StrReplaceAll(absl::CHexEscape(text.substr(0, most + 1)), {{"\\'", "'"}});
  if (escaped.size() > most) escaped = absl::StrCat(escaped.substr(0, most), "...");
  return escaped;
}

// A value of several words gets quotes.
std::string Quoted(absl::string_view value) {
  const std::string escaped = Escaped(value, kMaxValue);
  const bool is_word = escaped == value && value.find_first_of(" ()=") == value.npos;
  return is_word ? escaped : absl::StrCat("\"", escaped, "\"");
}

// If poll() says that a pipe or a socket has room, it has room for a line, and write() does not
// wait.
bool Put(absl::string_view line) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex) {
  pollfd room{STDERR_FILENO, POLLOUT, 0};
  const bool has_room = poll(&room, 1, dropped > 0 ? 0 : kPatienceMilliseconds) == 1;
  return has_room &&
         write(STDERR_FILENO, line.data(), line.size()) == static_cast<ssize_t>(line.size());
}

std::string Timed(const std::string& line) {
  return absl::StrCat(absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ ", absl::Now(), absl::UTCTimeZone()),
                      line);
}

std::string LossLine(int64_t lines) {
  return Timed(LogLine(Severity::kWarning,
                       "lines were dropped: the log was not read or could not be written",
                       {{"lines", lines}}));
}

}  // namespace

void SetLogLevel(Severity least) { least_severity = least; }

void Log(Severity severity, absl::string_view message, LogFields fields) {
  if (severity < least_severity) return;
  const std::string line = Timed(LogLine(severity, message, fields));
  MutexLock lock(mutex);
  if (dropped > 0 && Put(LossLine(dropped))) dropped = 0;
  if (dropped > 0 || !Put(line)) ++dropped;
}

std::string LogLine(Severity severity, absl::string_view message, LogFields fields) {
  const char* kind = severity == Severity::kInfo      ? ""
                     : severity == Severity::kWarning ? "warning: "
                                                      : "error: ";
  std::string told;
  for (const LogField& field : fields) {
    if (field.value.empty()) continue;
    absl::StrAppend(&told, told.empty() ? " (" : " ", field.name, "=", Quoted(field.value));
  }
  return absl::StrCat("ballpistond: ", kind,
                      absl::StrReplaceAll(Escaped(message, kMaxMessage), {{"\\\"", "\""}}), told,
                      told.empty() ? "\n" : ")\n");
}

}  // namespace ballpiston::server
