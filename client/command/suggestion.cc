#include "client/command/suggestion.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

// The smallest number of insertions, deletions, replacements and swaps of neighbouring letters that
// turns `a` into `b`.
size_t EditDistance(absl::string_view a, absl::string_view b) {
  std::vector<std::vector<size_t>> distance(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) {
    for (size_t j = 0; j <= b.size(); ++j) {
      size_t& best = distance[i][j] = std::max(i, j);
      if (i == 0 || j == 0) continue;
      best = std::min({distance[i - 1][j] + 1, distance[i][j - 1] + 1,
                       distance[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) best = std::min(best, distance[i - 2][j - 2] + 1);
    }
  }
  return distance[a.size()][b.size()];
}

}  // namespace

std::string DidYouMean(absl::string_view text, const std::vector<std::string>& names) {
  constexpr size_t kLongest = 64;  // every name is shorter; the time grows as the length squared
  if (text.size() > kLongest || names.empty()) return "";
  const auto nearer = [text](const std::string& a, const std::string& b) {
    return EditDistance(text, a) < EditDistance(text, b);
  };
  const std::string& nearest = *std::min_element(names.begin(), names.end(), nearer);
  // At most a third of the letters may be wrong; otherwise the suggestion would be a guess.
  const bool is_near = 3 * EditDistance(text, nearest) <= std::max(text.size(), nearest.size());
  return is_near ? absl::StrCat("; did you mean ", nearest, "?") : "";
}

std::string NotOneOf(absl::string_view text, const std::vector<std::string>& names) {
  return absl::StrCat(Quoted(text), " is not one of ", absl::StrJoin(names, ", "),
                      DidYouMean(text, names));
}

}  // namespace ballpiston::client
