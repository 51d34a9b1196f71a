#include "server/api/call.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "server/api/client_version.h"
#include "server/convert/errors.h"
#include "server/jobs/job_name.h"
#include "server/observability/call_observer.h"
#include "server/version.h"

namespace ballpiston::server {
namespace {

constexpr size_t kMaxRequestId = 64;

// The id is logged, so it may contain only characters that cannot be mistaken for other parts of a
// line.
bool IsRequestId(const std::string& id) {
  const auto permitted = [](unsigned char c) {
    return absl::ascii_isalnum(c) || c == '-' || c == '_' || c == '.';
  };
  return !id.empty() && id.size() <= kMaxRequestId && std::all_of(id.begin(), id.end(), permitted);
}

std::string RequestIdOf(const grpc::ServerContext& context) {
  const auto found = context.client_metadata().find(kRequestId);
  if (found == context.client_metadata().end()) return RandomId();
  const std::string id(found->second.data(), found->second.size());
  return IsRequestId(id) ? id : RandomId();
}

absl::string_view UserAgentOf(const grpc::ServerContext& context) {
  const auto found = context.client_metadata().find("user-agent");
  if (found == context.client_metadata().end()) return "";
  return {found->second.data(), found->second.size()};
}

absl::Status RoleTooLow(const Principal& caller, Role least) {
  return WithReason(
      absl::PermissionDeniedError(absl::StrCat(caller.name, " has the role ", RoleName(caller.role),
                                               ", this call needs the role ", RoleName(least))),
      "ROLE_TOO_LOW", "role", RoleName(least));
}

}  // namespace

absl::StatusOr<Call> AdmitCall(const ServiceContext& service, grpc::ServerContext& context,
                               const CallRule& rule) {
  Call call = {.method = rule.method, .request_id = RequestIdOf(context), .caller = {}};
  context.AddTrailingMetadata(kRequestId, call.request_id);
  if (absl::Status served = CheckClientVersion(UserAgentOf(context), kVersion); !served.ok()) {
    return served;
  }
  absl::StatusOr<Principal> caller = service.authenticator.Authenticate(context);
  if (!caller.ok()) return caller.status();
  call.caller = *std::move(caller);
  service.calls.Identify(context, call.caller.name);
  if (call.caller.role < rule.least) return RoleTooLow(call.caller, rule.least);
  return call;
}

}  // namespace ballpiston::server
