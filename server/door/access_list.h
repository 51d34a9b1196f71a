// The tokens that a server accepts: the lines of an access file, and the server's own token
// (own_token.h).
//
//   token sha256:HEX PRINCIPAL ROLE [EXPIRES]
//
//   HEX        64 hexadecimal digits: the SHA-256 of the token
//   PRINCIPAL  1 to 64 of a-z, A-Z, 0-9, '.', '_', '@' and '-', but not `local`, the server's own
//              user (principal.h)
//   ROLE       read | submit | admin (principal.h)
//   EXPIRES    2027-01-31T12:00:00Z, or a date, which means 00:00 UTC; rejected from then on
//
// A word that begins with '#' begins a comment. An error names the field and the permitted values,
// but does not quote the line: if the operator mixed up two fields, any field may contain a token.
//
// A list does not change while threads use it. A changed file gives a new list.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "server/door/principal.h"
#include "server/door/private_file.h"
#include "server/door/token_hash.h"

namespace ballpiston::server {

// Longer than every token that a server makes (new_token.h). Longer tokens are rejected without a
// look-up.
inline constexpr size_t kLongestToken = 256;

struct AccessEntry {
  TokenHash token;
  Principal principal;
  absl::Time expires = absl::InfiniteFuture();
};

// Empty for a line that is empty or only a comment.
absl::StatusOr<std::optional<AccessEntry>> ParseAccessEntry(absl::string_view line);

// The line of `entry`, without a newline.
std::string FormatAccessEntry(const AccessEntry& entry);

// INVALID_ARGUMENT says what is permitted.
absl::Status CheckPrincipalName(absl::string_view name);
absl::StatusOr<Role> ParseRole(absl::string_view text);

class AccessList {
 public:
  // INVALID_ARGUMENT names the flag, the file, the line and the permitted values, and contains no
  // secret. Two entries with the same token are an error.
  static absl::StatusOr<AccessList> Read(const NamedFile& file);
  static absl::StatusOr<AccessList> Parse(const NamedFile& file, absl::string_view text);

  size_t size() const { return entries_.size(); }
  bool Add(const AccessEntry& entry);  // false if the list already has the token

  // UNAUTHENTICATED, reason CREDENTIALS_INVALID or CREDENTIALS_EXPIRED. The token's hash is
  // compared with every entry, so the time does not tell which entry is similar.
  absl::StatusOr<Principal> OfToken(absl::string_view token, absl::Time now) const;

 private:
  const AccessEntry* Find(const TokenHash& token) const;

  std::vector<AccessEntry> entries_;
};

}  // namespace ballpiston::server
