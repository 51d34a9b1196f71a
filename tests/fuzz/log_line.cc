// A log message with any text of a client stays one well-formed line.
#include "server/observability/log_line.h"

#include <algorithm>

#include "absl/time/time.h"
#include "google/protobuf/struct.pb.h"
#include "google/protobuf/util/json_util.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

using server::LogFormat;

std::string Line(LogFormat format, const std::string& text) {
  return server::LogLine(format, absl::UnixEpoch(), server::Severity::kError, text,
                         {{"principal", text}, {"seconds", 0.5}});
}

void RequireOneLine(const std::string& line) {
  Require(line.size() <= server::kMaxLogLine, "a line fits into a pipe");
  Require(!line.empty() && line.find('\n') == line.size() - 1, "it is one");
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
  Require(std::none_of(line.begin(), line.end() - 1, is_control), "no control reaches a terminal");
}

void RequireJson(const std::string& line) {
  google::protobuf::Struct object;
  Require(google::protobuf::util::JsonStringToMessage(line, &object).ok(), "it is JSON");
  Require(object.fields().contains("severity"), "with a severity");
}

// Repeats the text until a message with it must be cut.
std::string Repeated(const std::string& text) {
  std::string repeated;
  while (!text.empty() && repeated.size() < server::kMaxLogLine) repeated += text;
  return repeated;
}

void CheckLogLine(const std::string& text) {
  const std::string message = IsOneIn(63, text) ? Repeated(text) : text;
  RequireOneLine(Line(LogFormat::kText, message));
  const std::string json = Line(LogFormat::kJson, message);
  RequireOneLine(json);
  if (IsOneIn(64, text)) RequireJson(json);  // also some of the cut lines
}

std::vector<std::string> Texts() {
  return {"ensembleJobs/1f0c was cancelled", "two\nlines and a \"quote\\",
          "\xe2\x80\xa8\xf0\x9f\x8e\xb1", "\xff\xfe\xc3(\x1b[2J", std::string(49, 'x')};
}

const Registration kLogLine({.name = "log_line", .check = CheckLogLine, .made_seeds = Texts});

}  // namespace
}  // namespace ballpiston::fuzz
