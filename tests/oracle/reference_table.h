// A csv table of reference values.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ballpiston {

class ReferenceTable {
 public:
  // Reads tests/data/<file>; fails the current test and stays empty if there is no such file.
  explicit ReferenceTable(const std::string& file);

  size_t rows() const { return cells_.size(); }
  double Input(size_t row, std::string_view column) const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> cells_;
};

}  // namespace ballpiston
