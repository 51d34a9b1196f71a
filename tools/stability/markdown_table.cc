#include "tools/stability/markdown_table.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace ballpiston::stability {

std::string MarkdownTable(Rows rows, size_t labels) {
  // From the end, so that each row is compared with one whose label is still there.
  for (size_t i = rows.size() - 1; i > 1; --i) {
    if (rows[i].front() == rows[i - 1].front()) rows[i].front().clear();
  }
  std::string rule = "|";
  for (size_t i = 0; i < rows.front().size(); ++i) {
    size_t width = 1;
    for (const auto& row : rows) width = std::max(width, row[i].size());
    const bool is_text = i < labels;
    for (auto& row : rows) {
      row[i].insert(is_text ? row[i].size() : 0, width - row[i].size(), ' ');
    }
    absl::StrAppend(&rule, is_text ? ":" : "-", std::string(width, '-'), is_text ? "-|" : ":|");
  }
  std::string text;
  for (const auto& row : rows) {
    absl::StrAppend(&text, "| ", absl::StrJoin(row, " | "), " |\n");
    if (&row == &rows.front()) absl::StrAppend(&text, rule, "\n");
  }
  return text;
}

std::string CountText(uint64_t count) {
  std::string text = absl::StrCat(count);
  for (size_t end = text.size(); end > 3; end -= 3) text.insert(end - 3, ",");
  return text;
}

std::string ErrorText(double error) {
  if (std::isnan(error)) return "-";
  return error == 0 ? "0" : absl::StrFormat("%.1e", error);
}

std::string SignedText(double value) { return absl::StrFormat("%+.1e", value); }

}  // namespace ballpiston::stability
