#include "server/security/authenticator.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/time/clock.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

// Properties of an auth context. No client can write them.
constexpr char kNameProperty[] = "ballpiston_unix_user";
constexpr char kAdminProperty[] = "ballpiston_unix_admin";

Credentials ShownBy(const grpc::ServerContextBase& context) {
  Credentials shown;
  const auto [begin, end] = context.client_metadata().equal_range("authorization");
  for (auto header = begin; header != end; ++header) {
    shown.authorization.emplace_back(header->second.data(), header->second.size());
  }
  const std::shared_ptr<const grpc::AuthContext> connection = context.auth_context();
  if (connection != nullptr) {
    shown.common_name = CommonNameOf(*connection);
    shown.unix_user = UnixUserOf(*connection);
  }
  return shown;
}

absl::StatusOr<Principal> OfUnixUser(const AccessList* list, const Principal& user,
                                     absl::Time now) {
  if (user.role == Role::kAdmin) return user;
  if (list != nullptr) return list->OfUser(user.name, now);
  if (CheckPrincipalName(user.name).ok()) return user;
  return UserNotListed(user.name);  // such as LAB\ada; a list can map it to a principal
}

}  // namespace

absl::StatusOr<Principal> Authenticator::Authenticate(
    const grpc::ServerContextBase& context) const {
  if (everybody_) return *everybody_;
  return Authenticate(ShownBy(context), absl::Now());
}

absl::StatusOr<Principal> Authenticator::Authenticate(const Credentials& shown,
                                                      absl::Time now) const {
  if (everybody_) return *everybody_;
  const std::shared_ptr<const AccessList> list = this->list();
  if (shown.unix_user) return OfUnixUser(list.get(), *shown.unix_user, now);
  if (list == nullptr) return CredentialsMissing();
  if (shown.authorization.size() == 1) {
    return list->OfToken(BearerToken(shown.authorization[0]), now);
  }
  if (!shown.authorization.empty()) return CredentialsInvalid();  // several: ambiguous
  if (shown.common_name) return list->OfCertificate(*shown.common_name, now);
  return CredentialsMissing();
}

void Authenticator::Replace(std::shared_ptr<const AccessList> list) {
  const MutexLock lock(mutex_);
  if (!everybody_) list_ = std::move(list);
}

std::shared_ptr<const AccessList> Authenticator::list() const {
  const MutexLock lock(mutex_);
  return list_;
}

std::optional<std::string> CommonNameOf(const grpc::AuthContext& context) {
  const auto names = context.FindPropertyValues("x509_common_name");
  if (names.size() != 1) return std::nullopt;
  return std::string(names[0].data(), names[0].size());
}

void SetUnixUser(grpc::AuthContext& context, const Principal& user) {
  context.AddProperty(kNameProperty, user.name);
  if (user.role == Role::kAdmin) context.AddProperty(kAdminProperty, "");
}

std::optional<Principal> UnixUserOf(const grpc::AuthContext& context) {
  const auto names = context.FindPropertyValues(kNameProperty);
  if (names.size() != 1) return std::nullopt;
  const bool is_admin = !context.FindPropertyValues(kAdminProperty).empty();
  return Principal{std::string(names[0].data(), names[0].size()),
                   is_admin ? Role::kAdmin : Role::kSubmit};
}

absl::string_view BearerToken(absl::string_view authorization) {
  constexpr absl::string_view kScheme = "Bearer ";
  if (!absl::StartsWithIgnoreCase(authorization, kScheme)) return {};
  return authorization.substr(kScheme.size());
}

}  // namespace ballpiston::server
