#include "server/api/resume_token.h"

#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace ballpiston::server {

std::string ResumeTokenText(const ResumeToken& token) {
  std::string text;
  absl::WebSafeBase64Escape(absl::StrCat(token.job, ":", token.finished, ":", token.instance, ":",
                                         token.change, ":", token.engine_version),
                            &text);
  return text;
}

std::optional<ResumeToken> ParseResumeToken(const std::string& text) {
  std::string told;
  if (!absl::WebSafeBase64Unescape(text, &told)) return std::nullopt;
  const std::vector<std::string> parts = absl::StrSplit(told, absl::MaxSplits(':', 4));
  ResumeToken token;
  if (parts.size() != 5 || !absl::SimpleAtoi(parts[1], &token.finished) ||
      !absl::SimpleAtoi(parts[3], &token.change) || token.finished < 0) {
    return std::nullopt;
  }
  token.job = parts[0];
  token.instance = parts[2];
  token.engine_version = parts[4];
  return token;
}

}  // namespace ballpiston::server
