// "did you mean ...?" for names that the user mistyped.
#pragma once

#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace ballpiston::client {

// "; did you mean NAME?" with the nearest of `names`, or "" if none of them is near enough.
std::string DidYouMean(absl::string_view text, const std::vector<std::string>& names);

// 'xml' is not one of table, json, jsonl, csv; did you mean ...?
std::string NotOneOf(absl::string_view text, const std::vector<std::string>& names);

}  // namespace ballpiston::client
