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

}  // namespace

template <typename Credential>
const AccessList::Holder* AccessList::Find(const Held<Credential>& held,
                                           const Credential& credential) {
  const auto found = std::find_if(held.begin(), held.end(),
                                  [&](const auto& entry) { return entry.first == credential; });
  return found == held.end() ? nullptr : &found->second;
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
      return AtLine(
          file, number,
          "the credential is already in an earlier line; permitted: one line for each credential");
    }
  }
  return list;
}

bool AccessList::Add(const AccessEntry& entry) {
  const auto add = [&](const auto& credential) {
    auto& held = HeldAs(credential);
    if (Find(held, credential) != nullptr) return false;
    held.emplace_back(credential, Holder{entry.principal, entry.expires});
    return true;
  };
  return std::visit(add, entry.credential);
}

absl::StatusOr<Principal> AccessList::OfToken(absl::string_view token, absl::Time now) const {
  if (token.empty() || token.size() > kLongestToken) return CredentialsInvalid();
  const TokenHash hash = HashOf(token);
  const Holder* found = nullptr;
  for (const auto& [known, holder] : tokens_) {  // compares all: constant time
    if (known == hash) found = &holder;
  }
  if (found == nullptr) return CredentialsInvalid();
  return Unexpired(*found, now);
}

absl::StatusOr<Principal> AccessList::OfCertificate(absl::string_view common_name,
                                                    absl::Time now) const {
  const Holder* const found = Find(certificates_, CommonName{std::string(common_name)});
  return found == nullptr ? CredentialsInvalid() : Unexpired(*found, now);
}

absl::StatusOr<Principal> AccessList::OfUser(const std::string& name, absl::Time now) const {
  const Holder* const found = Find(users_, UnixUser{name});
  return found == nullptr ? UserNotListed(name) : Unexpired(*found, now);
}

absl::StatusOr<Principal> AccessList::Unexpired(const Holder& holder, absl::Time now) {
  if (now < holder.expires) return holder.principal;
  return CredentialsExpired();
}

}  // namespace ballpiston::server
