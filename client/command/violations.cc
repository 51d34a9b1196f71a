#include "client/command/violations.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {
namespace {

// The payload that tells several violations from one whose text has several lines: all of them,
// with a character between them that no argument of a program can hold.
constexpr char kSeveral[] = "ballpiston.client/violations";
constexpr char kEnd = '\0';

}  // namespace

Violations::Violations(std::initializer_list<absl::Status> statuses) {
  for (const absl::Status& status : statuses) Add(status);
}

void Violations::Add(const absl::Status& status) {
  if (status.ok()) return;
  const auto several = status.GetPayload(kSeveral);
  const std::string texts(several.value_or(absl::Cord(status.message())));
  for (const absl::string_view text : absl::StrSplit(texts, kEnd)) {
    if (lines_.empty() || lines_.back() != text) lines_.emplace_back(text);
  }
}

absl::Status Violations::Lines() const {
  if (lines_.empty()) return absl::OkStatus();
  absl::Status status = absl::InvalidArgumentError(absl::StrJoin(lines_, "\n"));
  status.SetPayload(kSeveral, absl::Cord(absl::StrJoin(lines_, absl::string_view(&kEnd, 1))));
  return status;
}

absl::Status Violations::Report() const {
  if (lines_.empty()) return absl::OkStatus();
  if (lines_.size() == 1) return absl::InvalidArgumentError(lines_[0]);
  const auto shown = std::min(std::ssize(lines_), kMaxShown);
  const auto left_out = std::ssize(lines_) - shown;
  return absl::InvalidArgumentError(
      absl::StrCat("not valid, ", lines_.size(), " violations:\n  ",
                   absl::StrJoin(lines_.begin(), lines_.begin() + shown, "\n  "),
                   left_out > 0 ? absl::StrCat("\n  and ", left_out, " more") : ""));
}

}  // namespace ballpiston::client
