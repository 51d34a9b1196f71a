// A table in Markdown. Its columns are padded, so that it is also readable as plain text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ballpiston::stability {

class MarkdownTable {
 public:
  explicit MarkdownTable(std::vector<std::string> head) : rows_{std::move(head)} {}

  // A row has as many cells as the head. The first `labels` columns are texts, the others numbers.
  void Add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::string Text(size_t labels) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

std::string CountText(uint64_t count);  // 1,234,567
std::string ErrorText(double error);    // 1.2e-15; 0; - for NaN
std::string SignedText(double value);   // +1.2e-15

}  // namespace ballpiston::stability
