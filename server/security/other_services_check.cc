#include "server/security/other_services_check.h"

#include <string>

#include "absl/strings/match.h"
#include "absl/time/clock.h"
#include "server/convert/errors.h"

namespace ballpiston::server {

grpc::Status OtherServicesCheck::Process(const InputMetadata& metadata, grpc::AuthContext* context,
                                         OutputMetadata*, OutputMetadata*) {
  const auto path = metadata.find(":path");
  if (path != metadata.end() && PassesUnchecked({path->second.data(), path->second.size()})) {
    return grpc::Status::OK;
  }
  Credentials shown;
  const auto [begin, end] = metadata.equal_range("authorization");
  for (auto header = begin; header != end; ++header) {
    shown.authorization.emplace_back(header->second.data(), header->second.size());
  }
  shown.common_name = CommonNameOf(*context);
  return GrpcStatus(authenticator_.Authenticate(shown, absl::Now()).status());
}

bool PassesUnchecked(absl::string_view method) {
  return absl::StartsWith(method, "/grpc.health.v1.Health/") ||
         absl::StartsWith(method, "/ballpiston.v1.");
}

}  // namespace ballpiston::server
