// Aligned columns of text. The first row is the header. Columns of numbers are aligned right.
// Control characters are escaped, because texts of a server may change the terminal.
#pragma once

#include <ostream>
#include <set>
#include <string>
#include <vector>

namespace ballpiston::client {

class TextTable {
 public:
  // `left`: the titles of the columns that are aligned left. `optional`: those of the columns that
  // are left out if all their cells are empty.
  explicit TextTable(std::vector<std::string> titles, std::set<std::string> left = {},
                     const std::set<std::string>& optional = {});

  // One text for each column.
  void AddRow(std::vector<std::string> row);
  // A text across all columns; the columns' widths do not depend on it.
  void AddLine(const std::string& text);
  // Indents each line by `indent` blanks. No line ends with blanks.
  void Print(std::ostream& out, size_t indent = 0) const;

 private:
  struct Row {
    std::vector<std::string> cells;
    std::string line;  // used if there are no cells
  };

  std::string Line(const Row& row, size_t indent) const;

  const std::set<std::string> left_;
  std::vector<size_t> widths_;
  std::vector<bool> is_shown_;
  std::vector<Row> rows_;
};

}  // namespace ballpiston::client
