// A log message with any text of a client stays one well-formed line.
#include <algorithm>

#include "server/status/log.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

void RequireOneLine(const std::string& line) {
  Require(line.size() <= server::kMaxLogLine, "a line fits into a pipe");
  Require(!line.empty() && line.find('\n') == line.size() - 1, "it is one");
  const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
  Require(std::all_of(line.begin(), line.end() - 1, is_printable), "a line is printable ASCII");
}

// Repeats the text until a message with it must be cut.
std::string Repeated(const std::string& text) {
  std::string repeated;
  while (!text.empty() && repeated.size() < server::kMaxLogLine) repeated += text;
  return repeated;
}

void CheckLogLine(const std::string& text) {
  const std::string message = IsOneIn(63, text) ? Repeated(text) : text;
  RequireOneLine(server::LogLine(server::Severity::kError, message,
                                 {{"principal", message}, {"seconds", 0.5}}));
}

std::vector<std::string> Texts() {
  return {"ensembleJobs/1f0c was cancelled", "two\nlines and a \"quote\\",
          "\xe2\x80\xa8\xf0\x9f\x8e\xb1", "\xff\xfe\xc3(\x1b[2J", std::string(49, 'x')};
}

const Registration kLogLine({.name = "log_line", .check = CheckLogLine, .made_seeds = Texts});

}  // namespace
}  // namespace ballpiston::fuzz
