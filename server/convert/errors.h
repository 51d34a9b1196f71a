// Every error the API speaks of, by reason, and the one place where a status becomes gRPC's.
//
// A status made here carries its google.rpc.ErrorInfo (domain "ballpiston") and, where the request
// is wrong, a google.rpc.BadRequest as absl payloads. GrpcStatus packs them as google.rpc.Status
// into the error details, which together stay below kMaxErrorDetails: gRPC refuses trailers of
// 8 KiB. Violations that do not fit are counted in the metadata `violations_left_out` and in the
// message. Pure functions.
#ifndef BALLPISTON_SERVER_CONVERT_ERRORS_H_
#define BALLPISTON_SERVER_CONVERT_ERRORS_H_

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/experiment/ensemble_spec.h"
#include "core/experiment/point_summary.h"
#include "google/rpc/status.pb.h"
#include "grpcpp/support/status.h"
#include "server/security/principal.h"

namespace ballpiston::server {

inline constexpr size_t kMaxErrorDetails = 6 * 1024;

// INVALID_ARGUMENT, with every violation; at least one.
absl::Status InvalidSpec(const std::vector<FieldViolation>& violations);
absl::Status InvalidRequest(const std::vector<FieldViolation>& violations);
absl::Status InvalidField(std::string field, std::string description);  // the same, of one
absl::Status RequestIdReused(const std::string& request_id);

absl::Status JobNotFound(const std::string& name);  // NOT_FOUND
absl::Status JobAlreadyEnded(const std::string& name,
                             absl::string_view state);  // FAILED_PRECONDITION
absl::Status JobStillActive(const std::string& name,
                            absl::string_view state);  // FAILED_PRECONDITION
absl::Status ComparisonRunning();                      // RESOURCE_EXHAUSTED
absl::Status ShuttingDown();                           // UNAVAILABLE

// UNAUTHENTICATED. None says which credentials were shown.
absl::Status CredentialsMissing();
absl::Status CredentialsInvalid();
absl::Status CredentialsExpired();

// RESOURCE_EXHAUSTED: `what` is what there is too much of, `flag` that of the server which permits
// no more than `limit`.
absl::Status LimitExceeded(const std::string& reason, const std::string& what,
                           const std::string& flag, double limit);

absl::Status RoleTooLow(const Principal& caller, Role least);  // PERMISSION_DENIED

// DEADLINE_EXCEEDED: a point's budget was spent first. Says what was reached.
absl::Status ToleranceNotReached(const EnsembleSpec& spec, size_t point, const Estimate& reached);

// What a call answers when the store did not take it or could not be read. RESOURCE_EXHAUSTED,
// STORE_FULL: the disk is full. UNAVAILABLE, STORE_FAILED: anything else. OK stays OK, and a status
// that has a reason already keeps it.
absl::Status StoreFailure(const absl::Status& status);

// Any status, with the reason and domain that clients look for.
absl::Status WithReason(absl::Status status, const std::string& reason);
// The same, unless it has one.
absl::Status WithDefaultReason(absl::Status status, const std::string& reason);

// What a job that FAILED keeps.
google::rpc::Status RpcStatus(const absl::Status& status);

grpc::Status GrpcStatus(const absl::Status& status);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_CONVERT_ERRORS_H_
