// Who may come in: the entries of an access file, `#` comments and empty lines aside
// (access_entry.h tells what a line holds).
//
// Immutable, thus thread-safe; a changed file is a new list.
#ifndef BALLPISTON_SERVER_SECURITY_ACCESS_LIST_H_
#define BALLPISTON_SERVER_SECURITY_ACCESS_LIST_H_

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

// More than any server makes (new_token.h). What is longer is refused unread.
inline constexpr size_t kLongestToken = 256;

class AccessList {
 public:
  // INVALID_ARGUMENT names flag, file, line and what is permitted, and holds no secret; two entries
  // of one credential are refused.
  static absl::StatusOr<AccessList> Read(const NamedFile& file);
  static absl::StatusOr<AccessList> Parse(const NamedFile& file, absl::string_view text);

  size_t size() const { return tokens_.size() + certificates_.size() + users_.size(); }
  bool has_tokens() const { return !tokens_.empty(); }
  bool has_certificates() const { return !certificates_.empty(); }
  bool has_users() const { return !users_.empty(); }

  // UNAUTHENTICATED, reason CREDENTIALS_INVALID or CREDENTIALS_EXPIRED. How long it takes does not
  // depend on which entry the token is close to: its hash is compared with every one.
  absl::StatusOr<Principal> OfToken(absl::string_view token, absl::Time now) const;
  // The certificate has to have been verified already.
  absl::StatusOr<Principal> OfCertificate(absl::string_view common_name, absl::Time now) const;
  // The kernel has to have named the user.
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
  bool Add(const AccessEntry& entry);  // false if the credential is there already
  Held<TokenHash>& HeldAs(const TokenHash&) { return tokens_; }
  Held<CommonName>& HeldAs(const CommonName&) { return certificates_; }
  Held<UnixUser>& HeldAs(const UnixUser&) { return users_; }

  Held<TokenHash> tokens_;
  Held<CommonName> certificates_;
  Held<UnixUser> users_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_ACCESS_LIST_H_
