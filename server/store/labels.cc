#include "server/store/labels.h"

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

}  // namespace ballpiston::server
