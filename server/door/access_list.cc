#include "server/door/access_list.h"

#include <algorithm>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "server/convert/errors.h"
#include "server/sha256.h"

namespace ballpiston::server {
namespace {

constexpr size_t kLongestPrincipal = 64;
constexpr absl::string_view kHashPrefix = "sha256:";
constexpr Role kRoles[] = {Role::kRead, Role::kSubmit, Role::kAdmin};

absl::Status Wrong(absl::string_view field, absl::string_view permitted) {
  return absl::InvalidArgumentError(absl::StrCat(field, "; permitted: ", permitted));
}

absl::Status AtLine(const NamedFile& file, size_t line, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat(file.Text(), ", line ", line, ": ", what));
}

// Without the comment.
std::vector<absl::string_view> Words(absl::string_view line) {
  std::vector<absl::string_view> words =
      absl::StrSplit(line, absl::ByAnyChar(" \t\r\v\f"), absl::SkipEmpty());
  const auto comment = std::find_if(words.begin(), words.end(),
                                    [](absl::string_view word) { return word.front() == '#'; });
  words.erase(comment, words.end());
  return words;
}

absl::StatusOr<std::string> ParseHash(absl::string_view text) {
  const bool is_hash = absl::ConsumePrefix(&text, kHashPrefix) && text.size() == 2 * kSha256Bytes &&
                       std::all_of(text.begin(), text.end(),
                                   [](unsigned char c) { return absl::ascii_isxdigit(c); });
  if (is_hash) return absl::HexStringToBytes(text);
  return Wrong("the second word is not the SHA-256 of a token",
               "sha256: and 64 hexadecimal digits");
}

// A time or a date. Abseil would also accept "infinite-future".
absl::StatusOr<absl::Time> ParseExpiry(absl::string_view text) {
  absl::Time time;
  std::string ignored;
  const bool numeric = absl::ascii_isdigit(static_cast<unsigned char>(text.front()));
  if (numeric && (absl::ParseTime(absl::RFC3339_full, text, &time, &ignored) ||
                  absl::ParseTime("%Y-%m-%d", text, absl::UTCTimeZone(), &time, &ignored))) {
    return time;
  }
  return Wrong("the time of expiry is not a time or a date",
               "2027-01-31T12:00:00Z, 2027-01-31, or nothing");
}

}  // namespace

absl::StatusOr<std::optional<AccessEntry>> ParseAccessEntry(absl::string_view line) {
  const std::vector<absl::string_view> words = Words(line);
  if (words.empty()) return std::nullopt;
  if (words.size() < 4 || words.size() > 5 || words[0] != "token") {
    return Wrong("this is not the line of a token", "token sha256:HEX PRINCIPAL ROLE [EXPIRES]");
  }
  const auto hash = ParseHash(words[1]);
  if (!hash.ok()) return hash.status();
  if (const absl::Status name = CheckPrincipalName(words[2]); !name.ok()) return name;
  const auto role = ParseRole(words[3]);
  if (!role.ok()) return role.status();
  AccessEntry entry{*hash, {std::string(words[2]), *role}};
  if (words.size() == 4) return entry;
  const auto expires = ParseExpiry(words[4]);
  if (!expires.ok()) return expires.status();
  entry.expires = *expires;
  return entry;
}

std::string FormatAccessEntry(const AccessEntry& entry) {
  const std::string expiry =
      entry.expires == absl::InfiniteFuture()
          ? ""
          : absl::FormatTime(" %Y-%m-%dT%H:%M:%SZ", entry.expires, absl::UTCTimeZone());
  return absl::StrCat("token ", kHashPrefix, absl::BytesToHexString(entry.hash), " ",
                      entry.principal.name, " ", RoleName(entry.principal.role), expiry);
}

absl::Status CheckPrincipalName(absl::string_view name) {
  const auto permitted = [](unsigned char c) {
    return absl::ascii_isalnum(c) || c == '.' || c == '_' || c == '@' || c == '-';
  };
  if (!name.empty() && name.size() <= kLongestPrincipal && name != LocalPrincipal().name &&
      std::all_of(name.begin(), name.end(), permitted)) {
    return absl::OkStatus();
  }
  return Wrong(
      "the name of the principal is invalid",
      absl::StrCat("1 to ", kLongestPrincipal, " of a-z, A-Z, 0-9, '.', '_', '@' and '-', not ",
                   LocalPrincipal().name));
}

absl::StatusOr<Role> ParseRole(absl::string_view text) {
  for (const Role role : kRoles) {
    if (text == RoleName(role)) return role;
  }
  return Wrong("the role is unknown", "read, submit, admin");
}

absl::StatusOr<AccessList> AccessList::Read(const NamedFile& file) {
  const absl::StatusOr<std::string> text = ReadPrivateFile(file);
  if (!text.ok()) return text.status();
  return Parse(file, *text);
}

absl::StatusOr<AccessList> AccessList::Parse(const NamedFile& file, absl::string_view text) {
  AccessList list;
  size_t number = 0;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    ++number;
    const auto entry = ParseAccessEntry(line);
    if (!entry.ok()) return AtLine(file, number, entry.status().message());
    if (*entry && !list.Add(**entry)) {
      return AtLine(file, number,
                    "the token is already in an earlier line; permitted: one line for each token");
    }
  }
  return list;
}

absl::StatusOr<Principal> AccessList::OfToken(absl::string_view token, absl::Time now) const {
  if (token.empty() || token.size() > kLongestToken) return CredentialsInvalid();
  const auto found = entries_.find(Sha256(token));
  if (found == entries_.end()) return CredentialsInvalid();
  if (now < found->second.expires) return found->second.principal;
  return CredentialsExpired();
}

}  // namespace ballpiston::server
