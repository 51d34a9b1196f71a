// One line of an access file: a credential, its principal and role, and its time of expiry.
//
//   token sha256:HEX PRINCIPAL ROLE [EXPIRES]
//   certificate COMMON_NAME PRINCIPAL ROLE [EXPIRES]
//   user UNIX_USER PRINCIPAL ROLE [EXPIRES]
//
//   HEX          64 hexadecimal digits: the SHA-256 of a token
//   COMMON_NAME  of a client's certificate; in double quotes if it holds blanks
//   UNIX_USER    the name of a user of this machine, at a Unix socket that is open to other users
//   PRINCIPAL    1 to 64 of a-z, A-Z, 0-9, '.', '_', '@' and '-', but not `local`, the principal of
//                local connections (principal.h)
//   ROLE         read | submit | admin (principal.h)
//   EXPIRES      2027-01-31T12:00:00Z, or a date, which means 00:00 UTC; rejected from then on
//
// An error names the field and the permitted values, but does not quote the line: if the operator
// mixed up two fields, any field may contain a token. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "server/security/principal.h"
#include "server/security/token_hash.h"

namespace ballpiston::server {

struct CommonName {
  std::string text;
  bool operator==(const CommonName&) const = default;
};

struct UnixUser {
  std::string name;
  bool operator==(const UnixUser&) const = default;
};

struct AccessEntry {
  std::variant<TokenHash, CommonName, UnixUser> credential;
  Principal principal;
  absl::Time expires = absl::InfiniteFuture();
};

// Empty for a line that is empty or only a comment. A comment begins with a word that begins with
// '#'.
absl::StatusOr<std::optional<AccessEntry>> ParseAccessEntry(absl::string_view line);

// The line of `entry`, without a newline.
std::string FormatAccessEntry(const AccessEntry& entry);

// INVALID_ARGUMENT says what is permitted.
absl::Status CheckPrincipalName(absl::string_view name);
absl::StatusOr<Role> ParseRole(absl::string_view text);

}  // namespace ballpiston::server
