// Aligned columns of text. The first row is the header. Columns of numbers are aligned right.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace ballpiston::client {

class TextTable {
 public:
  struct Column {
    std::string title;
    enum { kLeft, kRight } alignment = kRight;
  };

  explicit TextTable(std::vector<Column> columns);

  // One text for each column.
  void AddRow(std::vector<std::string> row);
  // A text across all columns; the columns' widths do not depend on it.
  void AddLine(std::string text);
  // Indents each line by `indent` blanks. No line ends with blanks.
  void Print(std::ostream& out, size_t indent = 0) const;

 private:
  struct Row {
    std::vector<std::string> cells;
    std::string line;  // used if there are no cells
  };

  std::string Line(const Row& row, size_t indent) const;

  std::vector<Column> columns_;
  std::vector<size_t> widths_;
  std::vector<Row> rows_;
};

}  // namespace ballpiston::client
