#include "server/door/authenticator.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/time/clock.h"
#include "server/convert/errors.h"

namespace ballpiston::server {

absl::StatusOr<Principal> Authenticator::Authenticate(
    const grpc::ServerContextBase& context) const {
  std::vector<std::string> authorization;
  const auto [begin, end] = context.client_metadata().equal_range("authorization");
  for (auto header = begin; header != end; ++header) {
    authorization.emplace_back(header->second.data(), header->second.size());
  }
  return Authenticate(authorization, absl::Now());
}

absl::StatusOr<Principal> Authenticator::Authenticate(const std::vector<std::string>& authorization,
                                                      absl::Time now) const {
  if (!needs_tokens_) return LocalPrincipal();
  if (authorization.empty()) return CredentialsMissing();
  if (authorization.size() > 1) return CredentialsInvalid();  // ambiguous
  const MutexLock lock(mutex_);
  return list_.OfToken(BearerToken(authorization.front()), now);
}

void Authenticator::Accept(AccessList list) {
  const MutexLock lock(mutex_);
  list_ = std::move(list);
}

absl::string_view BearerToken(absl::string_view authorization) {
  constexpr absl::string_view kScheme = "Bearer ";
  if (!absl::StartsWithIgnoreCase(authorization, kScheme)) return {};
  return authorization.substr(kScheme.size());
}

}  // namespace ballpiston::server
