#include "tools/stability/markdown_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace ballpiston::stability {
namespace {

std::string Padded(const std::string& cell, size_t width, bool left) {
  const std::string space(width - std::min(width, cell.size()), ' ');
  return left ? cell + space : space + cell;
}

std::string Line(const std::vector<std::string>& cells, const std::vector<size_t>& widths,
                 size_t labels) {
  std::string line = "|";
  for (size_t i = 0; i < cells.size(); ++i) {
    absl::StrAppend(&line, " ", Padded(cells[i], widths[i], i < labels), " |");
  }
  return line + "\n";
}

std::string Rule(const std::vector<size_t>& widths, size_t labels) {
  std::string line = "|";
  for (size_t i = 0; i < widths.size(); ++i) {
    absl::StrAppend(&line, i < labels ? ":" : "-", std::string(widths[i], '-'),
                    i < labels ? "-|" : ":|");
  }
  return line + "\n";
}

}  // namespace

void MarkdownTable::Add(std::vector<std::string> row) {
  const std::string before = std::exchange(group_, row.front());
  if (group_ == before) row.front().clear();
  rows_.push_back(std::move(row));
}

std::string MarkdownTable::Text(size_t labels) const {
  std::vector<size_t> widths(rows_.front().size(), 1);
  for (const auto& row : rows_) {
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text = Line(rows_.front(), widths, labels) + Rule(widths, labels);
  for (size_t i = 1; i < rows_.size(); ++i) text += Line(rows_[i], widths, labels);
  return text;
}

std::string CountText(uint64_t count) {
  const std::string digits = absl::StrCat(count);
  std::string text;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text.push_back(',');
    text.push_back(digits[i]);
  }
  return text;
}

std::string ErrorText(double error) {
  if (std::isnan(error)) return "-";
  return error == 0 ? "0" : absl::StrFormat("%.1e", error);
}

std::string SignedText(double value) { return absl::StrFormat("%+.1e", value); }

}  // namespace ballpiston::stability
