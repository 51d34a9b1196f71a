#include "server/observability/log_line.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/observability/utf8.h"

namespace ballpiston::server {
namespace {

// Limits of the escaped texts. A message with at most twelve fields stays below kMaxLogLine.
constexpr size_t kMaxMessage = 1500;
constexpr size_t kMaxValue = 160;
constexpr absl::string_view kCut = "...";

// False for control characters, line and paragraph separators, and characters that change the
// direction of writing: they must not reach a terminal or end a line.
bool IsHarmless(uint32_t c) {
  const bool control = c < 0x20 || (c >= 0x7F && c < 0xA0);
  const bool separator = c == 0x2028 || c == 0x2029;
  const bool direction = (c >= 0x202A && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069);
  return !control && !separator && !direction;
}

void AppendUnit(uint32_t unit, std::string& text) {
  constexpr char kDigits[] = "0123456789abcdef";
  text += {'\\',
           'u',
           kDigits[unit >> 12],
           kDigits[unit >> 8 & 0xF],
           kDigits[unit >> 4 & 0xF],
           kDigits[unit & 0xF]};
}

// Appends the character as an escape sequence of JSON.
void AppendEscape(uint32_t c, std::string& text) {
  if (c == '\n') {
    text += "\\n";
  } else if (c < 0x10000) {
    AppendUnit(c, text);
  } else {
    AppendUnit(0xD800 + ((c - 0x10000) >> 10), text);
    AppendUnit(0xDC00 + ((c - 0x10000) & 0x3FF), text);
  }
}

// The length of the beginning that needs no escapes; for most texts the whole length.
size_t PlainLength(absl::string_view text, bool quoted) {
  const auto is_plain = [quoted](char c) {
    return c >= ' ' && c <= '~' && !(quoted && (c == '"' || c == '\\'));
  };
  return static_cast<size_t>(std::find_if_not(text.begin(), text.end(), is_plain) - text.begin());
}

// Takes the first character off the text.
void AppendFirst(absl::string_view& text, bool ascii, bool quoted, std::string& escaped) {
  const Utf8Character c = TakeUtf8(text);
  if (quoted && (c.code == '"' || c.code == '\\')) {
    escaped += {'\\', static_cast<char>(c.code)};
  } else if (!IsHarmless(c.code) || (ascii && c.code >= 0x80)) {
    AppendEscape(c.code, escaped);
  } else {
    escaped.append(c.bytes.data(), c.bytes.size());
  }
}

// `quoted`: quotes and backslashes are escaped as well. JSON has ASCII only. Beyond the limit the
// text is cut, between two characters.
std::string Escaped(absl::string_view text, bool ascii, bool quoted, size_t limit) {
  std::string escaped;
  while (!text.empty()) {
    const size_t plain =
        std::min(PlainLength(text.substr(0, limit), quoted), limit - escaped.size());
    escaped.append(text.data(), plain);
    text.remove_prefix(plain);
    if (text.empty()) break;
    const size_t whole = escaped.size();
    AppendFirst(text, ascii, quoted, escaped);
    if (escaped.size() <= limit) continue;
    escaped.resize(whole);
    return absl::StrCat(escaped, kCut);
  }
  return escaped;
}

const char* Name(Severity severity) {
  return severity == Severity::kInfo      ? "INFO"
         : severity == Severity::kWarning ? "WARNING"
                                          : "ERROR";
}

std::string JsonQuoted(absl::string_view text, size_t limit) {
  return absl::StrCat("\"", Escaped(text, true, true, limit), "\"");
}

std::string JsonLine(absl::Time now, Severity severity, absl::string_view message,
                     LogFields fields) {
  std::string line = absl::StrCat(
      "{\"time\":\"", absl::FormatTime("%Y-%m-%dT%H:%M:%E6SZ", now, absl::UTCTimeZone()),
      "\",\"severity\":\"", Name(severity), "\",\"message\":", JsonQuoted(message, kMaxMessage));
  for (const LogField& field : fields) {
    if (field.value.empty()) continue;
    absl::StrAppend(&line, ",\"", field.name,
                    "\":", field.is_number ? field.value : JsonQuoted(field.value, kMaxValue));
  }
  return absl::StrCat(line, "}\n");
}

bool IsPlain(absl::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) ||
           absl::string_view("-_./:@+%").find(c) != absl::string_view::npos;
  });
}

std::string TextValue(const LogField& field) {
  if (IsPlain(field.value) && field.value.size() <= kMaxValue) return field.value;
  return absl::StrCat("\"", Escaped(field.value, false, true, kMaxValue), "\"");
}

std::string TextFields(LogFields fields) {
  std::string text;
  for (const LogField& field : fields) {
    if (field.value.empty()) continue;
    absl::StrAppend(&text, text.empty() ? "" : " ", field.name, "=", TextValue(field));
  }
  return text;
}

std::string TextLine(Severity severity, absl::string_view message, LogFields fields) {
  const char* kind = severity == Severity::kInfo      ? ""
                     : severity == Severity::kWarning ? "warning: "
                                                      : "error: ";
  const std::string told = TextFields(fields);
  return absl::StrCat("ballpistond: ", kind, Escaped(message, false, false, kMaxMessage),
                      told.empty() ? "" : absl::StrCat(" (", told, ")"), "\n");
}

}  // namespace

// JSON has neither infinity nor NaN.
LogField::LogField(const char* field, double number)
    : name(field),
      value(std::isfinite(number) ? absl::StrFormat("%.9g", number) : "null"),
      is_number(true) {}

std::string LogLine(LogFormat format, absl::Time now, Severity severity, absl::string_view message,
                    LogFields fields) {
  return format == LogFormat::kJson ? JsonLine(now, severity, message, fields)
                                    : TextLine(severity, message, fields);
}

}  // namespace ballpiston::server
