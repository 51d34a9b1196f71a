#include "server/rpc/call.h"

#include <exception>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "server/rpc/client_version.h"
#include "server/status/log.h"
#include "server/version.h"

namespace ballpiston::server {
namespace {

// Empty if there is none.
std::string UserAgentOf(const grpc::ServerContext& context) {
  const auto found = context.client_metadata().find("user-agent");
  if (found == context.client_metadata().end()) return "";
  return {found->second.data(), found->second.size()};
}

absl::Status RoleTooLow(const Principal& caller, Role least) {
  return WithReason(
      absl::PermissionDeniedError(absl::StrCat(caller.name, " has the role ", RoleName(caller.role),
                                               ", this call needs the role ", RoleName(least))),
      "ROLE_TOO_LOW", {{"role", RoleName(least)}});
}

// Sets the caller.
absl::Status Admit(const ServiceContext& service, const grpc::ServerContext& context,
                   const CallRule& rule, Call& call) {
  absl::Status served = CheckClientVersion(UserAgentOf(context), kVersion);
  if (!served.ok()) return served;
  absl::StatusOr<Principal> caller = service.authenticator.Authenticate(context);
  if (!caller.ok()) return caller.status();
  call.caller = *std::move(caller);
  return call.caller.role < rule.least ? RoleTooLow(call.caller, rule.least) : absl::OkStatus();
}

// gRPC's own retries obey this metadata. Other clients read the details of the error.
void TellRetryDelay(grpc::ServerContext& context, const google::rpc::Status& error) {
  const absl::Duration delay = RetryDelayOf(error);
  if (delay == absl::ZeroDuration()) return;
  context.AddTrailingMetadata("grpc-retry-pushback-ms",
                              absl::StrCat(absl::ToInt64Milliseconds(delay)));
}

}  // namespace

void LogDone(const Call& call, const char* what, const std::string& job,
             const std::string& points) {
  Log(Severity::kInfo, what,
      {{"method", call.method}, {"job", job}, {"principal", call.caller.name}, {"points", points}});
}

grpc::Status ServeCall(ServiceContext& service, grpc::ServerContext& context, const CallRule& rule,
                       absl::FunctionRef<absl::Status(const Call&)> method) {
  const absl::Time begin = absl::Now();
  Call call = {.method = rule.method, .caller = {}, .is_abandoned = [&context] {
                 return context.IsCancelled();
               }};
  absl::Status status;
  try {
    status = Admit(service, context, rule, call);
    if (status.ok()) status = method(call);
  } catch (const std::exception& error) {
    status = WithReason(absl::InternalError(error.what()), "INTERNAL");
  }
  if (status.ok()) return grpc::Status::OK;
  const google::rpc::Status error = RpcStatus(status);
  TellRetryDelay(context, error);
  service.calls.Failed({.method = call.method,
                        .principal = call.caller.name,
                        .code = status.code(),
                        .reason = ReasonOf(error),
                        .message = std::string(status.message()),
                        .seconds = absl::ToDoubleSeconds(absl::Now() - begin)});
  return GrpcStatus(status);
}

grpc::Status ServeStream(ServiceContext& service, grpc::ServerContext& context,
                         const CallRule& rule, absl::FunctionRef<absl::Status(Stream&)> run) {
  return ServeCall(service, context, rule, [&](const Call& call) -> absl::Status {
    const auto open = service.quotas.streams.Take(call.caller.name);
    if (!open.ok()) return open.status();
    Stream stream(service.streams, context, call.caller);
    return run(stream);
  });
}

}  // namespace ballpiston::server
