// The server's log: one line per message, on standard error.
//
//   Log(Severity::kInfo, "job accepted", {{"job", name}, {"principal", caller.name}});
//
//   2026-01-02T03:04:05.678Z ballpistond: job accepted (job=ensembleJobs/1f0c principal=alice)
//
// If nobody reads the log, the server goes on: it drops lines, and writes their number before the
// next line. Never log a token, a key or another secret. Thread-safe.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

// A pipe accepts a line of this length in one piece.
inline constexpr size_t kMaxLogLine = 4096;

enum class Severity { kInfo, kWarning, kError, kNone };

// A name, and a text or a number. A field whose text is empty is left out.
struct LogField {
  LogField(const char* field, const absl::AlphaNum& text) : name(field), value(text.Piece()) {}

  const char* name;
  std::string value;
};

using LogFields = std::initializer_list<LogField>;

void Log(Severity severity, absl::string_view message, LogFields fields = {});
inline void LogInfo(absl::string_view message) { Log(Severity::kInfo, message); }
inline void LogError(absl::string_view message) { Log(Severity::kError, message); }

// Applies to the whole process: less severe messages are not written; with kNone none is.
void SetLogLevel(Severity least);

// The line without its time, with a newline. Messages and values may contain any bytes that a
// client sent: a line has only printable ASCII, and is cut to kMaxLogLine with at most twelve
// fields. Pure function.
std::string LogLine(Severity severity, absl::string_view message, LogFields fields = {});

}  // namespace ballpiston::server
