#include "server/api/resume_token.h"

#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace ballpiston::server {

std::string ResumeTokenText(const ResumeToken& token) {
  std::string text;
  absl::WebSafeBase64Escape(absl::StrCat(token.job, ":", token.restarts, ":", token.finished, ":",
                                         token.instance, ":", token.change),
                            &text);
  return text;
}

std::optional<ResumeToken> ParseResumeToken(const std::string& text) {
  std::string told;
  if (!absl::WebSafeBase64Unescape(text, &told)) return std::nullopt;
  const std::vector<std::string> parts = absl::StrSplit(told, ':');
  ResumeToken token;
  if (parts.size() != 5 || !absl::SimpleAtoi(parts[1], &token.restarts) ||
      !absl::SimpleAtoi(parts[2], &token.finished) || !absl::SimpleAtoi(parts[4], &token.change) ||
      token.finished < 0) {
    return std::nullopt;
  }
  token.job = parts[0];
  token.instance = parts[3];
  return token;
}

}  // namespace ballpiston::server
