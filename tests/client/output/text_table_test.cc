#include "client/output/text_table.h"

#include <gtest/gtest.h>

#include <sstream>

namespace ballpiston::client {
namespace {

std::string PrintedTable(const TextTable& table) {
  std::ostringstream out;
  table.Print(out, 1);
  return out.str();
}

TEST(TextTable, AlignsNumbersRightAndTextLeft) {
  TextTable table({"name", "value"}, {"name"});
  table.AddRow({"a", "1"});
  table.AddRow({"longer", "22.5"});
  table.AddRow({"b"});
  EXPECT_EQ(PrintedTable(table),
            " name    value\n"
            " a           1\n"
            " longer   22.5\n"
            " b\n");
}

TEST(TextTable, LineLiesAcrossAllColumns) {
  TextTable table({"name", "value"}, {"name"});
  table.AddRow({"a", "1"});
  table.AddLine("remark: wider than both columns");
  table.AddRow({"b", "22"});
  EXPECT_EQ(PrintedTable(table),
            " name  value\n"
            " a         1\n"
            " remark: wider than both columns\n"
            " b        22\n");
}

// µ has two bytes.
TEST(TextTable, MeasuresWidthInCharacters) {
  TextTable table({"work", "n"});
  table.AddRow({"120 µs", "1"});
  table.AddRow({"3.2 min", "2"});
  EXPECT_EQ(PrintedTable(table),
            "    work  n\n"
            "  120 µs  1\n"
            " 3.2 min  2\n");
}

}  // namespace
}  // namespace ballpiston::client
