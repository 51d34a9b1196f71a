#include "server/convert/errors.h"

#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/substitute.h"
#include "google/rpc/error_details.pb.h"

namespace ballpiston::server {
namespace {

constexpr char kTypePrefix[] = "type.googleapis.com/";
// The message is sent twice: in the details, and percent-encoded beside them.
constexpr size_t kMaxMessage = 512;
// The part of kMaxErrorDetails for violations; the rest is for message, reason and metadata.
constexpr size_t kMaxViolations = 4 * 1024;
constexpr size_t kMaxViolationText = 400;
constexpr size_t kMaxMetadataValue = 256;

// The first `bytes` bytes at most, cut between two characters of UTF-8.
std::string Shortened(absl::string_view text, size_t bytes) {
  if (text.size() <= bytes) return std::string(text);
  size_t end = bytes - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return absl::StrCat(std::string(text.substr(0, end)), "...");
}

template <typename Detail>
void SetDetail(absl::Status& status, const Detail& detail) {
  status.SetPayload(absl::StrCat(kTypePrefix, detail.GetTypeName()),
                    absl::Cord(detail.SerializeAsString()));
}

// The least seconds before a retry, for the errors that waiting cures. The store retries its writes
// every second. A limit on jobs stays reached until jobs end. Clients exit with 3 at a limit with a
// delay, with 2 at one without.
absl::Duration RetryDelayFor(const std::string& reason) {
  static const auto* const seconds =
      new std::map<std::string, int>{{"SHUTTING_DOWN", 1},    {"STORE_FULL", 1},
                                     {"STORE_FAILED", 1},     {"TOO_MANY_CALLS", 1},
                                     {"TOO_MANY_STREAMS", 5}, {"TOO_MANY_ACTIVE_POINTS", 10},
                                     {"TOO_MANY_JOBS", 10},   {"TOO_MANY_STORED_BYTES", 10}};
  const auto found = seconds->find(reason);
  return absl::Seconds(found == seconds->end() ? 0 : found->second);
}

bool HasReason(const absl::Status& status) {
  return status.GetPayload(absl::StrCat(kTypePrefix, google::rpc::ErrorInfo().GetTypeName()))
      .has_value();
}

template <typename Detail>
std::optional<Detail> FindDetail(const google::rpc::Status& error) {
  for (const google::protobuf::Any& any : error.details()) {
    if (Detail detail; any.UnpackTo(&detail)) return detail;
  }
  return std::nullopt;
}

google::rpc::BadRequest AsManyAsFit(const std::vector<FieldViolation>& violations) {
  google::rpc::BadRequest fitting;
  for (const FieldViolation& violation : violations) {
    google::rpc::BadRequest::FieldViolation* added = fitting.add_field_violations();
    added->set_field(Shortened(violation.field, kMaxViolationText));
    added->set_description(Shortened(violation.description, kMaxViolationText));
    if (fitting.ByteSizeLong() > kMaxViolations) {
      fitting.mutable_field_violations()->RemoveLast();
      break;
    }
  }
  return fitting;
}

std::string ViolationsText(const std::vector<FieldViolation>& violations) {
  const FieldViolation& first = violations.front();
  const std::string others =
      violations.size() == 1 ? "" : absl::StrCat(" (and ", violations.size() - 1, " more)");
  return absl::StrCat(Shortened(absl::StrCat(first.field, ": ", first.description), 400), others);
}

absl::Status Invalid(const std::string& reason, const std::vector<FieldViolation>& violations) {
  std::string text = ViolationsText(violations);
  std::map<std::string, std::string> metadata;
  const google::rpc::BadRequest fitting = AsManyAsFit(violations);
  const size_t left_out = violations.size() - static_cast<size_t>(fitting.field_violations_size());
  if (left_out > 0) {
    metadata["violations_left_out"] = absl::StrCat(left_out);
    absl::StrAppend(&text, "; ", left_out, " violations are left out of the details");
  }
  absl::Status status = WithReason(absl::InvalidArgumentError(text), reason, metadata);
  SetDetail(status, fitting);
  return status;
}

}  // namespace

absl::Status InvalidSpec(const std::vector<FieldViolation>& violations) {
  return Invalid("INVALID_SPEC", violations);
}

absl::Status InvalidRequest(const std::vector<FieldViolation>& violations) {
  return Invalid("INVALID_REQUEST", violations);
}

absl::Status FixedError::operator()(const std::string& first, const std::string& second) const {
  std::map<std::string, std::string> metadata;
  if (*key != '\0') metadata[key] = second.empty() ? first : second;
  return WithReason(absl::Status(code, absl::Substitute(text, first, second)), reason, metadata);
}

absl::Status LimitExceeded(const std::string& reason, const std::string& what,
                           const std::string& flag, double limit) {
  std::string text = absl::StrFormat("%s; this server permits %.15g", what, limit);
  std::map<std::string, std::string> metadata = {{"limit", absl::StrFormat("%.15g", limit)}};
  if (!flag.empty()) {
    absl::StrAppend(&text, " (--", flag, ")");
    metadata["flag"] = flag;
  }
  return WithReason(absl::ResourceExhaustedError(text), reason, metadata);
}

absl::Status ToleranceNotReached(const EnsembleSpec& spec, size_t point, const Estimate& reached) {
  const std::string error =
      reached.standard_error
          ? absl::StrFormat("%.2g", *reached.standard_error / std::fabs(reached.value))
          : "an unknown error";
  const std::optional<double>& budget = spec.target.budget_seconds;
  const std::string within = budget ? absl::StrFormat("within the budget of %g s", *budget)
                                    : "with the largest number of samples";
  return WithReason(absl::DeadlineExceededError(
                        absl::StrFormat("point %d: tolerance %g was not reached %s: reached %s",
                                        point, *spec.target.tolerance, within, error)),
                    "TOLERANCE_NOT_REACHED", {{"reached", error}});
}

absl::Status StoreFailure(const absl::Status& status) {
  if (status.ok() || HasReason(status)) return status;
  if (absl::IsDataLoss(status)) return WithReason(status, "STORE_DAMAGED");
  if (!absl::IsResourceExhausted(status)) {
    return WithReason(absl::UnavailableError(status.message()), "STORE_FAILED");
  }
  return WithReason(
      absl::UnavailableError(absl::StrCat(
          status.message(),
          "; delete jobs that are no longer needed, or make room on the server's disk")),
      "STORE_FULL");
}

absl::Status WithReason(absl::Status status, const std::string& reason,
                        const std::map<std::string, std::string>& metadata) {
  google::rpc::ErrorInfo info;
  info.set_reason(reason);
  info.set_domain("ballpiston");
  for (const auto& [key, value] : metadata) {
    (*info.mutable_metadata())[key] = Shortened(value, kMaxMetadataValue);
  }
  SetDetail(status, info);
  const absl::Duration delay = RetryDelayFor(reason);
  if (delay == absl::ZeroDuration()) return status;
  google::rpc::RetryInfo retry;
  retry.mutable_retry_delay()->set_seconds(absl::ToInt64Seconds(delay));
  SetDetail(status, retry);
  return status;
}

absl::Status WithDefaultReason(absl::Status status, const std::string& reason) {
  return HasReason(status) ? status : WithReason(std::move(status), reason);
}

google::rpc::Status RpcStatus(const absl::Status& status) {
  google::rpc::Status rpc;
  rpc.set_code(static_cast<int>(status.code()));
  rpc.set_message(Shortened({status.message().data(), status.message().size()}, kMaxMessage));
  status.ForEachPayload([&](absl::string_view type, const absl::Cord& value) {
    google::protobuf::Any* detail = rpc.add_details();
    detail->set_type_url(std::string(type));
    detail->set_value(std::string(value));
  });
  return rpc;
}

std::string ReasonOf(const google::rpc::Status& error) {
  const auto info = FindDetail<google::rpc::ErrorInfo>(error);
  return info ? info->reason() : std::string();
}

absl::Duration RetryDelayOf(const google::rpc::Status& error) {
  const auto retry = FindDetail<google::rpc::RetryInfo>(error);
  return retry ? absl::Seconds(retry->retry_delay().seconds()) : absl::ZeroDuration();
}

grpc::Status GrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  const google::rpc::Status rpc = RpcStatus(status);
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), rpc.message(),
                      rpc.SerializeAsString());
}

}  // namespace ballpiston::server
