#include "server/door/token_hash.h"

#include <openssl/crypto.h>

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"

namespace ballpiston::server {

bool operator==(const TokenHash& a, const TokenHash& b) {
  return a.bytes.size() == b.bytes.size() &&
         CRYPTO_memcmp(a.bytes.data(), b.bytes.data(), a.bytes.size()) == 0;
}

TokenHash HashOf(absl::string_view token) { return {Sha256(token)}; }

std::optional<TokenHash> ParseTokenHash(absl::string_view hex) {
  const bool digits =
      std::all_of(hex.begin(), hex.end(), [](unsigned char c) { return absl::ascii_isxdigit(c); });
  if (hex.size() != 2 * kSha256Bytes || !digits) return std::nullopt;
  return TokenHash{absl::HexStringToBytes(hex)};
}

std::string HexOf(const TokenHash& hash) { return absl::BytesToHexString(hash.bytes); }

}  // namespace ballpiston::server
