// What the server keeps of a token: its SHA-256, from which the token cannot be told. A plain hash
// is enough because a token is 256 random bits (new_token.h): there is nothing to guess, so nothing
// that a slow, salted hash would slow down. Pure functions.
#ifndef BALLPISTON_SERVER_SECURITY_TOKEN_HASH_H_
#define BALLPISTON_SERVER_SECURITY_TOKEN_HASH_H_

#include <optional>
#include <string>

#include "absl/strings/string_view.h"
#include "server/security/sha256.h"

namespace ballpiston::server {

struct TokenHash {
  std::string bytes;  // kSha256Bytes of them

  // In a time that does not depend on where they differ.
  friend bool operator==(const TokenHash& a, const TokenHash& b);
};

TokenHash HashOf(absl::string_view token);

// 64 hexadecimal digits of either case; empty if it is anything else.
std::optional<TokenHash> ParseTokenHash(absl::string_view hex);
std::string HexOf(const TokenHash& hash);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_TOKEN_HASH_H_
