// The entries of an access file, without comments and empty lines (access_entry.h describes a
// line).
//
// Immutable, and therefore thread-safe. A changed file gives a new list.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "server/security/access_entry.h"
#include "server/security/principal.h"
#include "server/security/private_file.h"

namespace ballpiston::server {

// Longer than every token that a server makes (new_token.h). Longer tokens are rejected without a
// look-up.
inline constexpr size_t kLongestToken = 256;

class AccessList {
 public:
  // INVALID_ARGUMENT names the flag, the file, the line and the permitted values, and contains no
  // secret. Two entries with the same credential are an error.
  static absl::StatusOr<AccessList> Read(const NamedFile& file);
  static absl::StatusOr<AccessList> Parse(const NamedFile& file, absl::string_view text);

  size_t size() const { return tokens_.size() + certificates_.size() + users_.size(); }
  bool has_tokens() const { return !tokens_.empty(); }
  bool has_certificates() const { return !certificates_.empty(); }
  bool has_users() const { return !users_.empty(); }

  // UNAUTHENTICATED, reason CREDENTIALS_INVALID or CREDENTIALS_EXPIRED. The token's hash is
  // compared with every entry, so the time does not tell which entry is similar.
  absl::StatusOr<Principal> OfToken(absl::string_view token, absl::Time now) const;
  // The caller must have verified the certificate.
  absl::StatusOr<Principal> OfCertificate(absl::string_view common_name, absl::Time now) const;
  // The name must come from the kernel (peer_user.h).
  absl::StatusOr<Principal> OfUser(const std::string& name, absl::Time now) const;

 private:
  struct Holder {
    Principal principal;
    absl::Time expires;
  };
  template <typename Credential>
  using Held = std::vector<std::pair<Credential, Holder>>;

  static absl::StatusOr<Principal> Unexpired(const Holder& holder, absl::Time now);
  template <typename Credential>
  static const Holder* Find(const Held<Credential>& held, const Credential& credential);
  bool Add(const AccessEntry& entry);  // false if the list already has the credential
  Held<TokenHash>& HeldAs(const TokenHash&) { return tokens_; }
  Held<CommonName>& HeldAs(const CommonName&) { return certificates_; }
  Held<UnixUser>& HeldAs(const UnixUser&) { return users_; }

  Held<TokenHash> tokens_;
  Held<CommonName> certificates_;
  Held<UnixUser> users_;
};

}  // namespace ballpiston::server
