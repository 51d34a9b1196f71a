// The labels of a job: short texts by which its owner finds it again.
#pragma once

#include <map>
#include <string>

#include "absl/strings/string_view.h"

namespace ballpiston::server {

using Labels = std::map<std::string, std::string>;  // key, value

inline constexpr size_t kMostLabels = 32;  // of a job

// As text in the job's row: a line KEY=VALUE for each. Neither part has a newline or an equals
// sign (rpc/request_check.h).
std::string LabelsText(const Labels& labels);
Labels LabelsOf(absl::string_view text);

}  // namespace ballpiston::server
