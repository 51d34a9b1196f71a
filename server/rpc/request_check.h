// Reads the fields of requests, and collects all violations.
//
//   RequestCheck check;
//   const std::string id = check.JobId("name", request.name());
//   if (!check.ok()) return check.status();
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "ballpiston/storage/tokens.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/book/job_book.h"
#include "server/book/job_list.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/errors.h"
#include "server/convert/spec.h"
#include "server/sha256.h"

namespace ballpiston::server {

// The text of the API's tokens: page tokens, and the resume tokens of watches
// (proto/ballpiston/storage/tokens.proto).
template <typename Token>
std::string TokenText(const Token& token) {
  return absl::WebSafeBase64Escape(token.SerializeAsString());
}

// Empty if the text is not a token. A text that no server made may still be one.
template <typename Token>
std::optional<Token> ParseToken(const std::string& text) {
  std::string bytes;
  Token token;
  if (!absl::WebSafeBase64Unescape(text, &bytes) || !token.ParseFromString(bytes)) {
    return std::nullopt;
  }
  return token;
}

// A page of a list ends before it has this many bytes (if it has an entry already).
inline constexpr size_t kMaxPageBytes = size_t{2} << 20;

// A hash of the list's name and its filters. All pages of one list have the same hash. The view may
// change from page to page.
template <typename Request>
std::string ListOf(Request request) {
  request.clear_page_size();
  request.clear_page_token();
  request.clear_view();
  return Sha256(absl::StrCat(request.GetTypeName(), DeterministicBytes(request))).substr(0, 8);
}

template <typename Request>
std::string NextPageToken(const Request& request, int64_t start) {
  storage::PageToken token;
  token.set_list(ListOf(request));
  token.set_start(start);
  return TokenText(token);
}

class RequestCheck {
 public:
  std::string JobId(const char* field, const std::string& name);

  // The request id: empty, or a UUID in its usual form. Returns it in lower case, so that equal
  // UUIDs are equal strings.
  std::string RequestId(const std::string& request_id);

  int32_t Priority(const char* field, int32_t priority);

  // At most kMostLabels; the permitted characters are in ensemble.proto.
  using LabelsField = google::protobuf::Map<std::string, std::string>;
  Labels LabelsIn(const char* field, const LabelsField& labels);

  // The fields in the request's mask.
  JobChange Change(const v1::UpdateEnsembleJobRequest& request);

  // A state or experiment must be a known one, and a time a valid google.protobuf.Timestamp (years
  // 1 to 9999). At most 100 violations of each list.
  JobFilter Filter(const v1::ListEnsembleJobsRequest& request);

  // 0 is the default, 50; more than 1000 counts as 1000.
  int PageSize(int32_t page_size);

  // Where the page begins; `first` if the token is empty. A token is valid only for the list and
  // the filters of the request that returned it.
  template <typename Request>
  int64_t PageStart(const Request& request, int64_t first) {
    return PageStart(request.page_token(), ListOf(request), first);
  }

  // Checks the view of the request, because proto3 accepts values that its enum View does not have.
  template <typename Request>
  void View(const Request& request) {
    if (Request::View_IsValid(request.view())) return;
    Add("view", absl::StrCat(int{request.view()}, " is not a view this server knows"));
  }

  void UnknownFields(const google::protobuf::Message& request) {
    AddUnknownFields("request", request, violations_);
  }

  void Add(std::string field, std::string description);

  bool ok() const { return violations_.empty(); }
  absl::Status status() const;  // OK, or INVALID_REQUEST with every violation
  const std::vector<FieldViolation>& violations() const { return violations_; }

 private:
  int64_t PageStart(const std::string& token, const std::string& list, int64_t first);
  void Range(const char* field, int64_t value, int64_t first, int64_t last);
  template <typename Enum>
  std::set<Enum> Values(const char* field, const google::protobuf::RepeatedField<int>& list);

  std::vector<FieldViolation> violations_;
};

}  // namespace ballpiston::server
