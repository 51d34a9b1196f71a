// The labels of a job: short texts by which its owner finds it again.
#pragma once

#include <map>
#include <string>

#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

using Labels = std::map<std::string, std::string>;  // key, value

inline constexpr size_t kMostLabels = 32;  // of a job

// The text of the labels in the job's row: KEY=VALUE for each label, with newlines between them. No
// key and no value is empty or contains a newline or an equals sign (rpc/request_check.h).
inline std::string LabelsText(const Labels& labels) {
  return absl::StrJoin(labels, "\n", absl::PairFormatter("="));
}
inline Labels LabelsOf(absl::string_view text) {
  return absl::StrSplit(text, absl::ByAnyChar("=\n"), absl::SkipEmpty());
}

}  // namespace ballpiston::server
