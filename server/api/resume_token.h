// What a watch's resume token says: of which job, and how far a watcher of it has been told. Opaque
// to clients, and anything may come back in its place. Pure functions.
#ifndef BALLPISTON_SERVER_API_RESUME_TOKEN_H_
#define BALLPISTON_SERVER_API_RESUME_TOKEN_H_

#include <cstdint>
#include <optional>
#include <string>

namespace ballpiston::server {

struct ResumeToken {
  std::string job;       // its id
  int64_t restarts = 0;  // of the job: its points of before are not those of after
  int64_t finished = 0;
  std::string instance;  // of the server's life in which `change` means something
  uint64_t change = 0;

  friend bool operator==(const ResumeToken&, const ResumeToken&) = default;
};

std::string ResumeTokenText(const ResumeToken& token);

// Nothing unless it is a token, of whatever job.
std::optional<ResumeToken> ParseResumeToken(const std::string& text);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_RESUME_TOKEN_H_
