// Every error of the API, by reason, and the one place where a status becomes a gRPC status.
//
// A status made here carries as absl payloads its google.rpc.ErrorInfo (domain "ballpiston"), where
// the request is wrong a google.rpc.BadRequest, and where waiting helps a google.rpc.RetryInfo.
// GrpcStatus packs them as google.rpc.Status into the error details, which together stay below
// kMaxErrorDetails: gRPC refuses trailers of 8 KiB. Violations that do not fit are counted in the
// metadata `violations_left_out` and in the message. Pure functions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/point_summary.h"
#include "google/rpc/status.pb.h"
#include "grpcpp/support/status.h"

namespace ballpiston::server {

inline constexpr size_t kMaxErrorDetails = 6 * 1024;

// INVALID_ARGUMENT, with every violation; at least one.
absl::Status InvalidSpec(const std::vector<FieldViolation>& violations);
absl::Status InvalidRequest(const std::vector<FieldViolation>& violations);
absl::Status RequestIdReused(const std::string& request_id);

absl::Status JobNotFound(const std::string& name);     // NOT_FOUND
absl::Status ResultNotFound(const std::string& name);  // NOT_FOUND
absl::Status ResultsExpired(const std::string& name);  // FAILED_PRECONDITION
absl::Status JobAlreadyEnded(const std::string& name,
                             absl::string_view state);  // FAILED_PRECONDITION
absl::Status JobStillActive(const std::string& name,
                            absl::string_view state);  // FAILED_PRECONDITION
absl::Status ShuttingDown();                           // UNAVAILABLE

// UNAUTHENTICATED. No message contains the credentials.
absl::Status CredentialsMissing();
absl::Status CredentialsInvalid();
absl::Status CredentialsExpired();

// RESOURCE_EXHAUSTED: `what` exceeds `limit`, which the server's flag `flag` sets; empty: no flag.
absl::Status LimitExceeded(const std::string& reason, const std::string& what,
                           const std::string& flag, double limit);

// DEADLINE_EXCEEDED: a point's budget was spent before the tolerance was reached. The message gives
// the error that was reached.
absl::Status ToleranceNotReached(const EnsembleSpec& spec, size_t point, const Estimate& reached);

inline constexpr char kEngineCrashed[] = "ENGINE_CRASHED";

// INTERNAL, ENGINE_CRASHED: the engine killed the process, or a worker elsewhere, `deaths` times
// while it computed this; `what` names the job's part.
absl::Status EngineCrashed(const std::string& what, int deaths);

// The status of a call when a write to the store or a read from it failed. UNAVAILABLE, STORE_FULL:
// the disk is full. DATA_LOSS, STORE_DAMAGED: the stored data cannot be read, and a retry does not
// help. UNAVAILABLE, STORE_FAILED: anything else. OK stays OK, and a status that has a reason
// already keeps it.
absl::Status StoreFailure(const absl::Status& status);

// The status with a reason and the project's domain, which clients read. The second form adds one
// entry of metadata.
absl::Status WithReason(absl::Status status, const std::string& reason);
absl::Status WithReason(absl::Status status, const std::string& reason, const std::string& key,
                        const std::string& value);
// The same, but keeps a reason that the status already has.
absl::Status WithDefaultReason(absl::Status status, const std::string& reason);

// The error that a FAILED job stores, and its reason; empty if it has none.
google::rpc::Status RpcStatus(const absl::Status& status);
std::string ReasonOf(const google::rpc::Status& error);

// The least time to wait before a retry. 0 if the error does not say that waiting helps.
absl::Duration RetryDelayOf(const google::rpc::Status& error);

grpc::Status GrpcStatus(const absl::Status& status);

}  // namespace ballpiston::server
