// A csv table of reference values with more digits than a double, and the errors of computed
// values.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ballpiston {

class ReferenceTable {
 public:
  // Reads tests/data/<file>; fails the current test and stays empty if there is no such file.
  explicit ReferenceTable(const std::string& file);

  size_t rows() const { return cells_.size(); }
  const std::vector<std::string>& columns() const { return columns_; }

  // An input, which is an exact double, and a reference value, of which 19 digits are kept.
  double Input(size_t row, std::string_view column) const;
  long double Reference(size_t row, std::string_view column) const;

 private:
  const std::string& Cell(size_t row, std::string_view column) const;

  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> cells_;
};

// Relative errors of computed values, by column and by row of a ReferenceTable.
class ErrorTable {
 public:
  // NaN counts as infinitely wrong, as does anything but zero where the reference is zero.
  void Add(size_t row, const std::string& column, double value, long double reference);

  double Worst(const std::string& column) const { return columns_.at(column).error; }
  double WorstOfAll() const;
  // Over the rows, of the largest error in each row.
  double MedianOfRows() const;

  // One line a column: the worst error and its row, and the same for `other`.
  void Print(const std::string& title, const ErrorTable& other,
             const std::string& other_title) const;

 private:
  struct Entry {
    double error = -1;
    size_t row = 0;
  };

  std::map<std::string, Entry> columns_;
  std::map<size_t, double> rows_;
};

}  // namespace ballpiston
