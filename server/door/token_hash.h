// The SHA-256 of a token: the server stores only this, and the token cannot be computed from it. A
// plain hash is enough because a token is 256 random bits (new_token.h). Nobody can guess it, so a
// slow, salted hash would not add security. Pure functions.
#pragma once

#include <optional>
#include <string>

#include "absl/strings/string_view.h"
#include "server/door/sha256.h"

namespace ballpiston::server {

struct TokenHash {
  std::string bytes;  // kSha256Bytes bytes

  // Constant-time comparison.
  friend bool operator==(const TokenHash& a, const TokenHash& b);
};

TokenHash HashOf(absl::string_view token);

// Parses 64 hexadecimal digits of either case; empty for any other text.
std::optional<TokenHash> ParseTokenHash(absl::string_view hex);
std::string HexOf(const TokenHash& hash);

}  // namespace ballpiston::server
