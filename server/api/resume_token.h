// The content of a watch's resume token: the job, and how much of it the client has received.
// Tokens are opaque to clients. A client may send any text as a token, so parsing must accept
// everything. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace ballpiston::server {

struct ResumeToken {
  std::string job;       // its id
  int64_t restarts = 0;  // of the job; a restart drops its points
  int64_t finished = 0;
  std::string instance;  // the server process that numbered `change`
  uint64_t change = 0;

  friend bool operator==(const ResumeToken&, const ResumeToken&) = default;
};

std::string ResumeTokenText(const ResumeToken& token);

// Empty if the text is not a token.
std::optional<ResumeToken> ParseResumeToken(const std::string& text);

}  // namespace ballpiston::server
