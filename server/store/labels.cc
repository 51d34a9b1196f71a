#include "server/store/labels.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace ballpiston::server {

std::string LabelsText(const Labels& labels) {
  std::string text;
  for (const auto& [key, value] : labels) absl::StrAppend(&text, key, "=", value, "\n");
  return text;
}

Labels LabelsOf(absl::string_view text) {
  Labels labels;
  for (const absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    labels.insert(
        std::pair<std::string, std::string>(absl::StrSplit(line, absl::MaxSplits('=', 1))));
  }
  return labels;
}

bool HasLabels(const Labels& labels, const Labels& wanted) {
  return std::ranges::all_of(wanted, [&labels](const auto& label) {
    const auto found = labels.find(label.first);
    return found != labels.end() && found->second == label.second;
  });
}

}  // namespace ballpiston::server
