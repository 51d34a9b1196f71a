// The tables of tests/data: rows of texts, by the names of their columns.
#pragma once

#include "tests/support/preamble.h"

namespace ballpiston::oracle {

using ReferenceRow = std::map<std::string, std::string>;

inline std::vector<ReferenceRow> ReferenceTable(const std::string& file) {
  const std::vector<std::string> lines =
      absl::StrSplit(Contents(SourcePath("tests/data/" + file)), '\n', absl::SkipEmpty());
  const std::vector<std::string> names = absl::StrSplit(lines.at(0), ',');
  std::vector<ReferenceRow> rows;
  for (size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> cells = absl::StrSplit(lines[i], ',');
    ReferenceRow& row = rows.emplace_back();
    for (size_t k = 0; k < names.size(); ++k) row[names[k]] = cells.at(k);
  }
  return rows;
}

inline double Number(const ReferenceRow& row, const std::string& column) {
  return std::stod(row.at(column));
}

}  // namespace ballpiston::oracle
