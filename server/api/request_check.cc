#include "server/api/request_check.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "server/jobs/job_name.h"

namespace ballpiston::server {
namespace {

constexpr int kDefaultPageSize = 50;
constexpr int kMaxPageSize = 1000;

std::string Quoted(const std::string& text) {
  return absl::StrCat("\"", absl::CEscape(text.substr(0, 100)), "\"");
}

bool IsUuid(const std::string& text) {
  if (text.size() != 36) return false;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool dash = i == 8 || i == 13 || i == 18 || i == 23;
    const auto c = static_cast<unsigned char>(text[i]);
    if (dash ? c != '-' : !absl::ascii_isxdigit(c)) return false;
  }
  return true;
}

}  // namespace

void RequestCheck::Add(std::string field, std::string description) {
  violations_.push_back({std::move(field), std::move(description)});
}

absl::Status RequestCheck::status() const {
  return ok() ? absl::OkStatus() : InvalidRequest(violations_);
}

std::string RequestCheck::JobId(const char* field, const std::string& name) {
  if (auto id = JobIdOf(name)) return *std::move(id);
  Add(field, absl::StrCat(Quoted(name),
                          " is not the name of a job; permitted: ensembleJobs/{id}, with an id of "
                          "lower-case letters, digits and -"));
  return std::string();
}

std::string RequestCheck::RequestId(const std::string& request_id) {
  if (request_id.empty()) return request_id;
  if (IsUuid(request_id)) return absl::AsciiStrToLower(request_id);
  Add("request_id",
      absl::StrCat(Quoted(request_id), " is not a UUID like 123e4567-e89b-12d3-a456-426614174000"));
  return std::string();
}

int RequestCheck::PageSize(int32_t page_size) {
  if (page_size < 0) {
    Add("page_size", absl::StrCat("is ", page_size, "; permitted: 0 (for ", kDefaultPageSize,
                                  ") to ", kMaxPageSize));
  }
  return page_size == 0 ? kDefaultPageSize : std::min<int>(page_size, kMaxPageSize);
}

int64_t RequestCheck::PageStart(const std::string& token, const std::string& list, int64_t first) {
  if (token.empty()) return first;
  const std::string prefix = absl::StrCat(list, ":");
  std::string text;
  int64_t start = 0;
  if (absl::WebSafeBase64Unescape(token, &text) && text.rfind(prefix, 0) == 0 &&
      absl::SimpleAtoi(text.substr(prefix.size()), &start) && start >= 0) {
    return start;
  }
  Add("page_token", absl::StrCat(Quoted(token), " is not a token of this list"));
  return first;
}

std::string RequestCheck::PageToken(const std::string& list, int64_t start) {
  std::string token;
  absl::WebSafeBase64Escape(absl::StrCat(list, ":", start), &token);
  return token;
}

}  // namespace ballpiston::server
