#include "tests/oracle/reference_table.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "gtest/gtest.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

std::vector<std::string> Fields(const std::string& line) {
  return absl::StrSplit(absl::StripSuffix(line, "\r"), ',');
}

}  // namespace

ReferenceTable::ReferenceTable(const std::string& file) {
  std::ifstream in(SourcePath("tests/data/" + file));
  EXPECT_TRUE(in.good()) << "no reference data: " << file;
  std::string line;
  if (std::getline(in, line)) columns_ = Fields(line);
  while (std::getline(in, line)) cells_.push_back(Fields(line));
}

double ReferenceTable::Input(size_t row, std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  const size_t index = static_cast<size_t>(found - columns_.begin());
  return std::strtod(cells_.at(row).at(index).c_str(), nullptr);
}

}  // namespace ballpiston
