#include "tests/oracle/reference_table.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>

#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "gtest/gtest.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

std::vector<std::string> Fields(const std::string& line) {
  return absl::StrSplit(absl::StripSuffix(line, "\r"), ',');
}

double ErrorOf(double value, long double reference) {
  if (static_cast<long double>(value) == reference) return 0;
  const long double error = std::abs((value - reference) / reference);
  return std::isfinite(error) ? static_cast<double>(error)
                              : std::numeric_limits<double>::infinity();
}

}  // namespace

ReferenceTable::ReferenceTable(const std::string& file) {
  std::ifstream in(SourcePath("tests/data/" + file));
  EXPECT_TRUE(in.good()) << "no reference data: " << file;
  std::string line;
  if (std::getline(in, line)) columns_ = Fields(line);
  while (std::getline(in, line)) cells_.push_back(Fields(line));
}

const std::string& ReferenceTable::Cell(size_t row, std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  return cells_.at(row).at(static_cast<size_t>(found - columns_.begin()));
}

double ReferenceTable::Input(size_t row, std::string_view column) const {
  return std::strtod(Cell(row, column).c_str(), nullptr);
}

long double ReferenceTable::Reference(size_t row, std::string_view column) const {
  return std::strtold(Cell(row, column).c_str(), nullptr);
}

void ErrorTable::Add(size_t row, const std::string& column, double value, long double reference) {
  const double error = ErrorOf(value, reference);
  Entry& entry = columns_[column];
  if (error > entry.error) entry = {error, row};
  rows_[row] = std::max(rows_[row], error);
}

double ErrorTable::WorstOfAll() const {
  double worst = 0;
  for (const auto& [column, entry] : columns_) worst = std::max(worst, entry.error);
  return worst;
}

double ErrorTable::MedianOfRows() const {
  std::vector<double> errors;
  for (const auto& [row, error] : rows_) errors.push_back(error);
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

void ErrorTable::Print(const std::string& title, const ErrorTable& other,
                       const std::string& other_title) const {
  std::cout << absl::StrFormat("%-18s %12s %12s   row, row\n", "worst error", title, other_title);
  for (const auto& [column, entry] : columns_) {
    const Entry& beside = other.columns_.at(column);
    std::cout << absl::StrFormat("%-18s %12.1e %12.1e   %d, %d\n", column, entry.error,
                                 beside.error, entry.row, beside.row);
  }
  std::cout << absl::StrFormat("%-18s %12.1e %12.1e\n", "median of rows", MedianOfRows(),
                               other.MedianOfRows());
}

}  // namespace ballpiston
