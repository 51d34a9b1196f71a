#include "client/output/text_table.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {
namespace {

// The number of characters, not of bytes. In UTF-8 all bytes of a character but the first begin
// with the bits 10.
size_t Width(const std::string& text) {
  return static_cast<size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) >> 6) != 2; }));
}

// The text with its control characters as \x1b. In UTF-8 those from U+0080 to U+009F begin with c2.
std::string Escaped(absl::string_view text) {
  std::string escaped;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool has_two = text[i] == '\xc2' && i + 1 < text.size() && text[i + 1] < '\xa0';
    const auto c = static_cast<unsigned char>(text[has_two ? ++i : i]);
    if (has_two || absl::ascii_iscntrl(c)) {
      absl::StrAppend(&escaped, "\\x", absl::Hex(c, absl::kZeroPad2));
    } else {
      escaped += text[i];
    }
  }
  return escaped;
}

}  // namespace

TextTable::TextTable(std::vector<std::string> titles, std::set<std::string> left,
                     const std::set<std::string>& optional)
    : left_(std::move(left)), widths_(titles.size(), 0), is_shown_(titles.size()) {
  AddRow(titles);
  for (size_t i = 0; i < titles.size(); ++i) is_shown_[i] = !optional.contains(titles[i]);
}

void TextTable::AddRow(std::vector<std::string> row) {
  row.resize(widths_.size());
  for (size_t i = 0; i < row.size(); ++i) {
    row[i] = Escaped(row[i]);
    widths_[i] = std::max(widths_[i], Width(row[i]));
    if (!row[i].empty()) is_shown_[i] = true;
  }
  rows_.push_back({.cells = std::move(row), .line = ""});
}

void TextTable::AddLine(const std::string& text) {
  rows_.push_back({.cells = {}, .line = Escaped(text)});
}

std::string TextTable::Line(const Row& row, size_t indent) const {
  std::string line = std::string(indent, ' ') + row.line;
  const char* separator = "";
  for (size_t i = 0; i < row.cells.size(); ++i) {
    if (!is_shown_[i]) continue;
    const std::string& cell = row.cells[i];
    const std::string padding(widths_[i] - Width(cell), ' ');
    const bool left = left_.contains(rows_[0].cells[i]);
    absl::StrAppend(&line, separator, left ? "" : padding, cell, left ? padding : "");
    separator = "  ";
  }
  absl::StripTrailingAsciiWhitespace(&line);
  return line;
}

void TextTable::Print(std::ostream& out, size_t indent) const {
  for (const Row& row : rows_) out << Line(row, indent) << '\n';
}

}  // namespace ballpiston::client
