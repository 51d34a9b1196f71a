// A table in Markdown. Its columns are padded, so that it is also readable as plain text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ballpiston::stability {

class MarkdownTable {
 public:
  explicit MarkdownTable(std::vector<std::string> head) : rows_{std::move(head)} {}

  // A row has as many cells as the head. The first cell is left empty if it repeats that of the row
  // before.
  void Add(std::vector<std::string> row);
  // The first `labels` columns are texts, the others numbers.
  std::string Text(size_t labels) const;

 private:
  std::vector<std::vector<std::string>> rows_;
  std::string group_;  // the first cell of the last row
};

std::string CountText(uint64_t count);  // 1,234,567
std::string ErrorText(double error);    // 1.2e-15; 0; - for NaN
std::string SignedText(double value);   // +1.2e-15
inline const char* YesOrNo(bool is_true) { return is_true ? "yes" : "no"; }

}  // namespace ballpiston::stability
