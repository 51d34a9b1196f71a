// Texts that the server reads or writes.
#include "server/door/access_list.h"
#include "server/door/authenticator.h"
#include "server/door/new_token.h"
#include "server/status/log.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

// Calls with the text as credentials.
void CheckCalls(const server::AccessList& list, const std::string& text) {
  server::Authenticator door(/*needs_tokens=*/true);
  door.Accept(list);
  const absl::Time now = absl::FromUnixSeconds(1'800'000'000);
  for (const std::vector<std::string>& shown :
       {std::vector<std::string>{text}, {"Bearer " + text}, {text, text}, {}}) {
    const auto caller = door.Authenticate(shown, now);
    if (caller.ok()) {
      Require(server::CheckPrincipalName(caller->name).ok(), "who comes in has a name");
    } else {
      Require(absl::IsUnauthenticated(caller.status()), "who is refused is told so");
      RequireSendable(caller.status(), text);
    }
  }
}

// Entries of tokens, which the server itself writes.
void CheckWritten(const std::string& line) {
  const auto entry = server::ParseAccessEntry(line);
  if (!entry.ok() || !entry->has_value()) return;
  if ((*entry)->expires != absl::InfiniteFuture()) return;
  const auto again = server::ParseAccessEntry(server::FormatAccessEntry(**entry));
  Require(again.ok() && again->has_value(), "what is written can be read");
  Require((*again)->hash == (*entry)->hash, "a token stays");
  Require((*again)->principal.name == (*entry)->principal.name, "a principal stays");
  Require((*again)->principal.role == (*entry)->principal.role, "a role stays");
}

// The error contains no token and no hash. Both are longer than every word of a message.
void RequireSilence(const absl::Status& error, const std::string& text) {
  constexpr size_t kLongerThanAnyWordOfOurs = 32;
  for (const absl::string_view word : absl::StrSplit(text, absl::ByAnyChar(" \t\r\n"))) {
    if (word.size() <= kLongerThanAnyWordOfOurs) continue;
    Require(!absl::StrContains(error.message(), word), "nothing of the file is told");
  }
}

// The access file, the credentials of a call, and --new-token. Errors do not quote the rejected
// text.
void CheckAccessList(const std::string& text) {
  const auto list = server::AccessList::Parse({"access-file", "FILE"}, text);
  if (list.ok()) {
    CheckCalls(*list, text);
  } else {
    Require(absl::IsInvalidArgument(list.status()), "the error is INVALID_ARGUMENT");
    Require(absl::StartsWith(list.status().message(), "--access-file=FILE, line "),
            "flag and line are named");
    RequireSilence(list.status(), text);
  }
  CheckWritten(text);
  const auto request = server::ParseTokenRequest(text);
  Require(!request.ok() || server::CheckPrincipalName(request->principal.name).ok(),
          "a token is somebody's");
}

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

// A log message with any text of a client stays one well-formed line that keeps its last field.
void CheckLogLine(const std::string& text) {
  const std::string message = IsOneIn(63, text) ? Repeated(text) : text;
  const std::string line = server::LogLine(server::Severity::kError, message,
                                           {{"principal", message}, {"seconds", 0.5}});
  RequireOneLine(line);
  Require(line.ends_with("seconds=0.5)\n"), "the last field stays");
}

std::vector<std::string> Texts() {
  return {"ensembleJobs/1f0c was cancelled", "two\nlines and a \"quote\\",
          "\xe2\x80\xa8\xf0\x9f\x8e\xb1", "\xff\xfe\xc3(\x1b[2J", std::string(49, 'x')};
}

}  // namespace

std::vector<FuzzTarget> ServerTextTargets() {
  return {
      {"access_list", CheckAccessList},
      {"log_line", CheckLogLine, nullptr, Texts},
  };
}

}  // namespace ballpiston::fuzz
