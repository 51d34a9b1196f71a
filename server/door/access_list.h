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
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "server/door/principal.h"
#include "server/door/private_file.h"

namespace ballpiston::server {

// Longer than every token that a server makes (new_token.h). Longer tokens are rejected without a
// look-up.
inline constexpr size_t kLongestToken = 256;

// The server stores a plain hash of a token. That is enough because a token is 256 random bits
// (new_token.h): nobody can guess one, and the time of a look-up tells nothing about it.
struct AccessEntry {
  std::string hash;  // SHA-256 of the token
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
  // False if the list already has the token.
  bool Add(const AccessEntry& entry) { return entries_.emplace(entry.hash, entry).second; }

  // UNAUTHENTICATED, reason CREDENTIALS_INVALID or CREDENTIALS_EXPIRED.
  absl::StatusOr<Principal> OfToken(absl::string_view token, absl::Time now) const;

 private:
  std::map<std::string, AccessEntry> entries_;  // by their hashes
};

}  // namespace ballpiston::server
