// "did you mean ...?" for names that the user mistyped.
#ifndef BALLPISTON_CLIENT_COMMAND_SUGGESTION_H_
#define BALLPISTON_CLIENT_COMMAND_SUGGESTION_H_

#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace ballpiston::client {

// The fewest insertions, deletions, replacements and swaps of neighbours between two texts.
size_t EditDistance(absl::string_view a, absl::string_view b);

// "; did you mean NAME?" for the nearest of `names` if it is near enough, else "".
std::string DidYouMean(absl::string_view text, const std::vector<std::string>& names);

// 'xml' is not one of table, json, jsonl, csv; did you mean ...?
std::string NotOneOf(absl::string_view text, const std::vector<std::string>& names);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_SUGGESTION_H_
