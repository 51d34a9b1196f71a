// One line of the log, as text. Pure functions.
//
//   kText  ballpistond: error: message (job=ensembleJobs/1f0c principal=alice)
//   kJson  {"time":"2026-01-02T03:04:05.678901Z","severity":"ERROR","message":"...","job":"..."}
//
// Messages and values may contain any bytes that a client sent. Control characters, quotes and
// invalid UTF-8 are escaped, so that a message stays one line and cannot imitate another line.
// Messages and values are cut so that a line has at most kMaxLogLine bytes, which a pipe accepts in
// one piece.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>

#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace ballpiston::server {

inline constexpr size_t kMaxLogLine = 4096;

enum class Severity { kInfo, kWarning, kError };
enum class LogFormat { kText, kJson };

// A name and a text or a number. A field whose text is empty is left out.
struct LogField {
  LogField(const char* field, absl::string_view text) : name(field), value(text) {}
  LogField(const char* field, double number);

  const char* name;
  std::string value;
  bool is_number = false;
};

using LogFields = std::initializer_list<LogField>;

// The result ends with a newline.
std::string LogLine(LogFormat format, absl::Time now, Severity severity, absl::string_view message,
                    LogFields fields);

}  // namespace ballpiston::server
