// Reads the fields that many requests share, and collects all violations.
//
//   RequestCheck check;
//   const std::string id = check.JobId("name", request.name());
//   if (!check.ok()) return check.status();
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"

namespace ballpiston::server {

// A page of a list ends before it has this many bytes (if it has an entry already).
inline constexpr size_t kMaxPageBytes = size_t{2} << 20;

class RequestCheck {
 public:
  std::string JobId(const char* field, const std::string& name);

  // The request id: empty, or a UUID in its usual form. Returns it in lower case, so that equal
  // UUIDs are equal strings.
  std::string RequestId(const std::string& request_id);

  // 0 is the default, 50; more than 1000 counts as 1000.
  int PageSize(int32_t page_size);

  // Where the page begins; `first` if the token is empty. Tokens are opaque and valid only for the
  // list that returned them.
  int64_t PageStart(const std::string& token, const std::string& list, int64_t first);
  static std::string PageToken(const std::string& list, int64_t start);

  // Checks the view of the request, because proto3 accepts values that its enum View does not have.
  template <typename Request>
  void View(const Request& request) {
    if (Request::View_IsValid(request.view())) return;
    Add("view", absl::StrCat(int{request.view()}, " is not a view this server knows"));
  }

  void Add(std::string field, std::string description);

  bool ok() const { return violations_.empty(); }
  absl::Status status() const;  // OK, or INVALID_REQUEST with every violation
  const std::vector<FieldViolation>& violations() const { return violations_; }

 private:
  std::vector<FieldViolation> violations_;
};

}  // namespace ballpiston::server
