#include "server/security/access_entry.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace ballpiston::server {
namespace {

constexpr size_t kLongestName = 64;
constexpr size_t kLongestCredential = 256;  // a common name, a user's name
constexpr absl::string_view kHashPrefix = "sha256:";
constexpr Role kRoles[] = {Role::kRead, Role::kSubmit, Role::kAdmin};

absl::Status Wrong(absl::string_view field, absl::string_view permitted) {
  return absl::InvalidArgumentError(absl::StrCat(field, "; permitted: ", permitted));
}

bool IsBlank(char c) { return absl::ascii_isspace(static_cast<unsigned char>(c)); }

// Removes the first word from the line. A word in double quotes may contain blanks. Empty at the
// end of the line and at a comment.
absl::StatusOr<absl::string_view> TakeWord(absl::string_view& line) {
  line = absl::StripLeadingAsciiWhitespace(line);
  if (line.empty() || line[0] == '#') return absl::string_view();
  const bool quoted = absl::ConsumePrefix(&line, "\"");
  const auto ends = [quoted](char c) { return quoted ? c == '"' : IsBlank(c); };
  const auto size =
      static_cast<size_t>(std::find_if(line.begin(), line.end(), ends) - line.begin());
  if (quoted && (size == 0 || size == line.size())) {
    return Wrong("a quotation mark is missing, or the quotes are empty", "\"WORDS\"");
  }
  const absl::string_view word = line.substr(0, size);
  line.remove_prefix(size + (quoted ? 1 : 0));
  return word;
}

absl::StatusOr<std::vector<absl::string_view>> Words(absl::string_view line) {
  std::vector<absl::string_view> words;
  while (true) {
    const auto word = TakeWord(line);
    if (!word.ok()) return word.status();
    if (word->empty()) return words;
    words.push_back(*word);
  }
}

absl::StatusOr<decltype(AccessEntry::credential)> ParseCredential(absl::string_view kind,
                                                                  absl::string_view text) {
  if (kind == "token") {
    const auto hash = absl::ConsumePrefix(&text, kHashPrefix) ? ParseTokenHash(text) : std::nullopt;
    if (hash) return *hash;
    return Wrong("the second word is not the SHA-256 of a token",
                 "sha256: and 64 hexadecimal digits");
  }
  if (kind != "certificate" && kind != "user") {
    return Wrong("the first word is not a kind of credential", "token, certificate, user");
  }
  if (text.size() > kLongestCredential) {
    return Wrong("the second word is too long", absl::StrCat("at most ", kLongestCredential));
  }
  if (kind == "user") return UnixUser{std::string(text)};
  return CommonName{std::string(text)};
}

std::string Text(const TokenHash& hash) { return absl::StrCat("token ", kHashPrefix, HexOf(hash)); }
std::string Text(const CommonName& name) { return absl::StrCat("certificate \"", name.text, "\""); }
std::string Text(const UnixUser& user) { return absl::StrCat("user \"", user.name, "\""); }

// A time or a date. Abseil would also accept "infinite-future".
absl::StatusOr<absl::Time> ParseExpiry(absl::string_view text) {
  absl::Time time;
  std::string ignored;
  const bool numeric = !text.empty() && absl::ascii_isdigit(static_cast<unsigned char>(text[0]));
  if (numeric && (absl::ParseTime(absl::RFC3339_full, text, &time, &ignored) ||
                  absl::ParseTime("%Y-%m-%d", text, absl::UTCTimeZone(), &time, &ignored))) {
    return time;
  }
  return Wrong("the time of expiry is not a time or a date",
               "2027-01-31T12:00:00Z, 2027-01-31, or nothing");
}

}  // namespace

absl::StatusOr<std::optional<AccessEntry>> ParseAccessEntry(absl::string_view line) {
  const auto words = Words(line);
  if (!words.ok()) return words.status();
  if (words->empty()) return std::nullopt;
  if (words->size() < 4 || words->size() > 5) {
    return Wrong(absl::StrCat("there are ", words->size(), " words"),
                 "token sha256:HEX PRINCIPAL ROLE [EXPIRES], certificate COMMON_NAME PRINCIPAL "
                 "ROLE [EXPIRES], or user UNIX_USER PRINCIPAL ROLE [EXPIRES]");
  }
  const auto credential = ParseCredential((*words)[0], (*words)[1]);
  if (!credential.ok()) return credential.status();
  if (const absl::Status name = CheckPrincipalName((*words)[2]); !name.ok()) return name;
  const auto role = ParseRole((*words)[3]);
  if (!role.ok()) return role.status();
  AccessEntry entry{*credential, {std::string((*words)[2]), *role}};
  if (words->size() == 4) return entry;
  const auto expires = ParseExpiry((*words)[4]);
  if (!expires.ok()) return expires.status();
  entry.expires = *expires;
  return entry;
}

std::string FormatAccessEntry(const AccessEntry& entry) {
  const std::string credential =
      std::visit([](const auto& one) { return Text(one); }, entry.credential);
  const std::string expiry =
      entry.expires == absl::InfiniteFuture()
          ? ""
          : absl::FormatTime(" %Y-%m-%dT%H:%M:%SZ", entry.expires, absl::UTCTimeZone());
  return absl::StrCat(credential, " ", entry.principal.name, " ", RoleName(entry.principal.role),
                      expiry);
}

absl::Status CheckPrincipalName(absl::string_view name) {
  const auto permitted = [](unsigned char c) {
    return absl::ascii_isalnum(c) || c == '.' || c == '_' || c == '@' || c == '-';
  };
  if (!name.empty() && name.size() <= kLongestName && name != LocalPrincipal().name &&
      std::all_of(name.begin(), name.end(), permitted)) {
    return absl::OkStatus();
  }
  return Wrong("the name of the principal is invalid",
               absl::StrCat("1 to ", kLongestName, " of a-z, A-Z, 0-9, '.', '_', '@' and '-', not ",
                            LocalPrincipal().name));
}

absl::StatusOr<Role> ParseRole(absl::string_view text) {
  for (const Role role : kRoles) {
    if (text == RoleName(role)) return role;
  }
  return Wrong("the role is unknown", "read, submit, admin");
}

}  // namespace ballpiston::server
