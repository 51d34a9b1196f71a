#include "server/security/access_list.h"

#include <algorithm>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

absl::Status AtLine(const NamedFile& file, size_t line, absl::string_view what) {
  return absl::InvalidArgumentError(
      absl::StrCat(file.Text(), ", line ", line, ": ", std::string(what)));
}

// Whether one of them has this credential already.
template <typename Credential, typename Holder>
bool Holds(const std::vector<std::pair<Credential, Holder>>& held, const Credential& credential) {
  return std::any_of(held.begin(), held.end(),
                     [&](const auto& entry) { return entry.first == credential; });
}

}  // namespace

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
      return AtLine(file, number, "the credential is that of an earlier line; permitted: one each");
    }
  }
  return list;
}

bool AccessList::Add(const AccessEntry& entry) {
  const Holder holder{entry.principal, entry.expires};
  if (const auto* hash = std::get_if<TokenHash>(&entry.credential)) {
    if (Holds(tokens_, *hash)) return false;
    tokens_.emplace_back(*hash, holder);
    return true;
  }
  const auto& name = std::get<std::string>(entry.credential);
  if (Holds(certificates_, name)) return false;
  certificates_.emplace_back(name, holder);
  return true;
}

absl::StatusOr<Principal> AccessList::OfToken(absl::string_view token, absl::Time now) const {
  if (token.empty() || token.size() > kLongestToken) return CredentialsInvalid();
  const TokenHash hash = HashOf(token);
  const Holder* found = nullptr;
  for (const auto& [known, holder] : tokens_) {  // all of them: no early end to be timed
    if (known == hash) found = &holder;
  }
  if (found == nullptr) return CredentialsInvalid();
  return Unexpired(*found, now);
}

absl::StatusOr<Principal> AccessList::OfCertificate(absl::string_view common_name,
                                                    absl::Time now) const {
  for (const auto& [known, holder] : certificates_) {
    if (known == common_name) return Unexpired(holder, now);
  }
  return CredentialsInvalid();
}

absl::StatusOr<Principal> AccessList::Unexpired(const Holder& holder, absl::Time now) {
  if (now < holder.expires) return holder.principal;
  return CredentialsExpired();
}

}  // namespace ballpiston::server
