#include "server/security/authenticator.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/time/clock.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

Credentials ShownBy(const grpc::ServerContextBase& context) {
  Credentials shown;
  const auto [begin, end] = context.client_metadata().equal_range("authorization");
  for (auto header = begin; header != end; ++header) {
    shown.authorization.emplace_back(header->second.data(), header->second.size());
  }
  const std::shared_ptr<const grpc::AuthContext> connection = context.auth_context();
  if (connection != nullptr) shown.common_name = CommonNameOf(*connection);
  return shown;
}

}  // namespace

absl::StatusOr<Principal> Authenticator::Authenticate(
    const grpc::ServerContextBase& context) const {
  if (list() == nullptr) return LocalPrincipal();
  return Authenticate(ShownBy(context), absl::Now());
}

absl::StatusOr<Principal> Authenticator::Authenticate(const Credentials& shown,
                                                      absl::Time now) const {
  const std::shared_ptr<const AccessList> list = this->list();
  if (list == nullptr) return LocalPrincipal();
  if (shown.authorization.size() == 1) {
    return list->OfToken(BearerToken(shown.authorization[0]), now);
  }
  if (!shown.authorization.empty()) return CredentialsInvalid();  // which of them would count?
  if (shown.common_name) return list->OfCertificate(*shown.common_name, now);
  return CredentialsMissing();
}

void Authenticator::Replace(std::shared_ptr<const AccessList> list) {
  const std::lock_guard lock(mutex_);
  if (list_ != nullptr) list_ = std::move(list);
}

std::shared_ptr<const AccessList> Authenticator::list() const {
  const std::lock_guard lock(mutex_);
  return list_;
}

std::optional<std::string> CommonNameOf(const grpc::AuthContext& context) {
  const auto names = context.FindPropertyValues("x509_common_name");
  if (names.size() != 1) return std::nullopt;
  return std::string(names[0].data(), names[0].size());
}

absl::string_view BearerToken(absl::string_view authorization) {
  constexpr absl::string_view kScheme = "Bearer ";
  if (!absl::StartsWithIgnoreCase(authorization, kScheme)) return {};
  return authorization.substr(kScheme.size());
}

}  // namespace ballpiston::server
