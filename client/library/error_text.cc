#include "client/library/error_text.h"

#include <cstdint>
#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"

namespace ballpiston::client {
namespace {

// The details of this type, merged; empty if there is none.
template <typename Detail>
Detail Find(const google::rpc::Status& status) {
  Detail all;
  for (const google::protobuf::Any& any : status.details()) {
    if (Detail detail; any.UnpackTo(&detail)) all.MergeFrom(detail);
  }
  return all;
}

std::string TextOf(const google::rpc::BadRequest::FieldViolation& violation) {
  return absl::StrCat(violation.field(), ": ", violation.description());
}

int LeftOut(const google::rpc::ErrorInfo& info) {
  const auto entry = info.metadata().find("violations_left_out");
  int count = 0;
  if (entry == info.metadata().end() || !absl::SimpleAtoi(entry->second, &count)) return 0;
  return count;
}

std::string Text(const std::string& message, const google::rpc::Status& status) {
  const auto info = Find<google::rpc::ErrorInfo>(status);
  const std::string reason = info.reason().empty() ? "" : absl::StrCat(" (", info.reason(), ")");
  const auto request = Find<google::rpc::BadRequest>(status);
  const int64_t left_out = LeftOut(info);
  const int64_t count = request.field_violations_size() + left_out;
  if (count == 0) return message + reason;
  if (count == 1 && left_out == 0) return TextOf(request.field_violations(0)) + reason;
  std::string text = absl::StrCat("not valid, ", count, " violations", reason, ":");
  for (const auto& violation : request.field_violations()) text += "\n  " + TextOf(violation);
  return left_out > 0 ? absl::StrCat(text, "\n  and ", left_out, " more") : text;
}

// gRPC 1.51 writes "Received message larger than max (SIZE vs. MOST)", or "Sent ...". If the server
// lacks the method, gRPC's text is empty.
std::string PlainText(absl::StatusCode code, absl::string_view text) {
  if (code == absl::StatusCode::kUnimplemented && text.empty()) {
    return "the server has an earlier version, which does not offer this call";
  }
  if (text.empty()) {  // for instance because a text is not UTF-8
    return absl::StrCat("the call failed without a message: ", absl::StatusCodeToString(code));
  }
  const size_t begin = text.find("message larger than max (");
  if (code != absl::StatusCode::kResourceExhausted || begin == absl::string_view::npos) {
    return std::string(text);
  }
  const absl::string_view sizes = text.substr(text.find('(', begin) + 1);
  const std::pair<absl::string_view, absl::string_view> size_and_most =
      absl::StrSplit(absl::StripSuffix(sizes, ")"), absl::MaxSplits(" vs. ", 1));
  return absl::StrCat("the request or its answer ", kTooLarge, ": ", size_and_most.first,
                      " bytes; at most ", size_and_most.second, " are permitted");
}

}  // namespace

absl::Status FromGrpc(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  const auto code = static_cast<absl::StatusCode>(status.error_code());  // the same numbers
  google::rpc::Status details;
  if (status.error_details().empty() || !details.ParseFromString(status.error_details())) {
    return absl::Status(code, PlainText(code, status.error_message()));
  }
  absl::Status result(code, Text(status.error_message(), details));
  result.SetPayload(kStatusPayload, absl::Cord(status.error_details()));
  return result;
}

google::rpc::Status ErrorDetails(const absl::Status& status) {
  google::rpc::Status details;
  const auto payload = status.GetPayload(kStatusPayload);
  if (!payload || !details.ParseFromString(std::string(*payload))) details.Clear();
  return details;
}

std::string ErrorReason(const absl::Status& status) {
  return Find<google::rpc::ErrorInfo>(ErrorDetails(status)).reason();
}

absl::Duration RetryDelay(const absl::Status& status) {
  const auto delay = Find<google::rpc::RetryInfo>(ErrorDetails(status)).retry_delay();
  return absl::Seconds(delay.seconds()) + absl::Nanoseconds(delay.nanos());
}

google::rpc::BadRequest ErrorViolations(const absl::Status& status) {
  return Find<google::rpc::BadRequest>(ErrorDetails(status));
}

}  // namespace ballpiston::client
