// Tables in Markdown, and the numbers in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ballpiston::stability {

using Rows = std::vector<std::vector<std::string>>;

// The first row is the head; all rows have as many cells. The first `labels` columns are texts, the
// others numbers. The columns are padded, so that the table is also readable as plain text. A first
// cell that repeats that of the row before is left empty.
std::string MarkdownTable(Rows rows, size_t labels);

std::string CountText(uint64_t count);  // 1,234,567
std::string ErrorText(double error);    // 1.2e-15; 0; - for NaN
std::string SignedText(double value);   // +1.2e-15
inline const char* YesOrNo(bool is_true) { return is_true ? "yes" : "no"; }

}  // namespace ballpiston::stability
