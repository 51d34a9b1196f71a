// Every error of the API, by reason, and the one place where a status becomes a gRPC status.
//
// A status made here carries as absl payloads its google.rpc.ErrorInfo (domain "ballpiston"), where
// the request is wrong a google.rpc.BadRequest, and where waiting helps a google.rpc.RetryInfo.
// GrpcStatus packs them as google.rpc.Status into the error details, which together stay below
// kMaxErrorDetails: gRPC refuses trailers of 8 KiB. Violations that do not fit are counted in the
// metadata `violations_left_out` and in the message. Pure functions.
#pragma once

#include <cstddef>
#include <map>
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

// An error whose text is fixed except for at most two arguments, $0 and $1:
// JobNotFound("ensembleJobs/1f0c").
struct FixedError {
  absl::StatusCode code;
  const char* reason;
  const char* key;  // of the metadata with the last argument; empty: none
  const char* text;

  absl::Status operator()(const std::string& first = "", const std::string& second = "") const;
};
inline constexpr FixedError RequestIdReused = {
    absl::StatusCode::kInvalidArgument, "REQUEST_ID_REUSED", "request_id",
    "request_id $0 was used before with a different request"};
inline constexpr FixedError JobNotFound = {absl::StatusCode::kNotFound, "JOB_NOT_FOUND", "name",
                                           "no such job: $0"};
inline constexpr FixedError ResultNotFound = {
    absl::StatusCode::kNotFound, "RESULT_NOT_FOUND", "name",
    "no such result: $0; the point is not finished, or not in the grid"};
inline constexpr FixedError ResultsExpired = {
    absl::StatusCode::kFailedPrecondition, "RESULTS_EXPIRED", "name",
    "the results of $0 have expired; submit its specification again"};
// For the next two, $0 is the job's name and $1 its state.
inline constexpr FixedError JobAlreadyEnded = {absl::StatusCode::kFailedPrecondition,
                                               "JOB_ALREADY_ENDED", "state",
                                               "$0 has ended already: it is $1"};
inline constexpr FixedError JobStillActive = {absl::StatusCode::kFailedPrecondition,
                                              "JOB_STILL_ACTIVE", "state",
                                              "$0 is $1: cancel it, or wait until it has ended"};
inline constexpr FixedError ShuttingDown = {absl::StatusCode::kUnavailable, "SHUTTING_DOWN", "",
                                            "the server is shutting down; retry later"};
// No message contains the credentials.
inline constexpr FixedError CredentialsMissing = {
    absl::StatusCode::kUnauthenticated, "CREDENTIALS_MISSING", "",
    "this server requires a token: --token-file FILE, or the header authorization: Bearer TOKEN"};
inline constexpr FixedError CredentialsInvalid = {absl::StatusCode::kUnauthenticated,
                                                  "CREDENTIALS_INVALID", "",
                                                  "this server does not know these credentials"};
inline constexpr FixedError CredentialsExpired = {
    absl::StatusCode::kUnauthenticated, "CREDENTIALS_EXPIRED", "",
    "these credentials have expired; ask for new ones"};
// $0 is the part of a job. $1 is how often the engine killed the process, or a worker elsewhere,
// while it computed this part.
inline constexpr FixedError EngineCrashed = {
    absl::StatusCode::kInternal, "ENGINE_CRASHED", "",
    "the engine crashed $1 times while it computed $0: this is a fault of the program, not of the "
    "question; please report it with the specification. The points that were finished before stay"};

// RESOURCE_EXHAUSTED: `what` exceeds `limit`, which the server's flag `flag` sets; empty: no flag.
absl::Status LimitExceeded(const std::string& reason, const std::string& what,
                           const std::string& flag, double limit);

// DEADLINE_EXCEEDED: a point's budget was spent, or it had the largest number of samples, before
// the tolerance was reached. The message gives the error that was reached.
absl::Status ToleranceNotReached(const EnsembleSpec& spec, size_t point, const Estimate& reached);

// The status of a call when a write to the store or a read from it failed. UNAVAILABLE, STORE_FULL:
// the disk is full. DATA_LOSS, STORE_DAMAGED: the stored data cannot be read, and a retry does not
// help. UNAVAILABLE, STORE_FAILED: anything else. OK stays OK, and a status that has a reason
// already keeps it.
absl::Status StoreFailure(const absl::Status& status);

// The status with a reason, the project's domain and metadata, which clients read.
absl::Status WithReason(absl::Status status, const std::string& reason,
                        const std::map<std::string, std::string>& metadata = {});
// The same, but keeps a reason that the status already has.
absl::Status WithDefaultReason(absl::Status status, const std::string& reason);

// The error that a FAILED job stores, and its reason; empty if it has none.
google::rpc::Status RpcStatus(const absl::Status& status);
std::string ReasonOf(const google::rpc::Status& error);

// The least time to wait before a retry. 0 if the error does not say that waiting helps.
absl::Duration RetryDelayOf(const google::rpc::Status& error);

grpc::Status GrpcStatus(const absl::Status& status);

}  // namespace ballpiston::server
