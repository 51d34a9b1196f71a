#include "client/command/points_file.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/command/number_list.h"
#include "client/command/suggestion.h"
#include "client/output/number_text.h"
#include "client/output/table.h"

namespace ballpiston::client {
namespace {

using google::protobuf::FieldDescriptor;
using Columns = std::vector<const FieldDescriptor*>;
using Texts = std::vector<absl::string_view>;

Texts CellsOf(absl::string_view line) {
  Texts cells = absl::StrSplit(line, ',');
  for (absl::string_view& cell : cells) {
    cell = absl::StripAsciiWhitespace(cell);
    if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"') {
      cell = cell.substr(1, cell.size() - 2);
    }
  }
  return cells;
}

template <typename... Parts>
absl::Status Wrong(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

// A column names a list of the grid, but not that of the columns themselves.
absl::Status ReadHeader(const std::string& line, const Texts& names, v1::Grid& grid,
                        Columns& columns) {
  std::vector<std::string> parameters = FieldNames(*v1::Grid::descriptor());
  std::erase(parameters, "table");
  for (const absl::string_view name : names) {
    const auto found = std::find(parameters.begin(), parameters.end(), name);
    if (found == parameters.end()) {
      return Wrong(line, ": the column ", NotOneOf(name, parameters));
    }
    const FieldDescriptor* field = v1::Grid::descriptor()->FindFieldByName(*found);
    if (std::find(columns.begin(), columns.end(), field) != columns.end()) {
      return Wrong(line, ": the column ", name, " is there twice");
    }
    if (grid.GetReflection()->FieldSize(grid, field) > 0) {
      return Wrong("has the column ", name, ", and --", name, " is given; permitted: one of them");
    }
    columns.push_back(field);
    grid.add_table(*found);
  }
  return absl::OkStatus();
}

absl::Status AddCell(const FieldDescriptor& column, absl::string_view text, v1::Grid& grid) {
  const google::protobuf::Reflection& reflection = *grid.GetReflection();
  if (column.cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
    reflection.AddString(&grid, &column, ShapeText(text));
    return absl::OkStatus();
  }
  const absl::StatusOr<double> number = ParseNumber(text);
  if (number.ok()) reflection.AddDouble(&grid, &column, *number);
  return number.status();
}

absl::Status ReadRow(const std::string& line, const Texts& cells, const Columns& columns,
                     v1::Grid& grid) {
  if (cells.size() != columns.size()) {
    return Wrong(line, " has ", Counted(static_cast<double>(cells.size()), "value"),
                 "; the header names ", Counted(static_cast<double>(columns.size()), "column"));
  }
  for (size_t i = 0; i < cells.size(); ++i) {
    const absl::Status added = AddCell(*columns[i], cells[i], grid);
    if (added.ok()) continue;
    return Wrong(line, ", column ", columns[i]->name(), ": ", added.message());
  }
  return absl::OkStatus();
}

absl::Status ReadTable(absl::string_view csv, v1::Grid& grid) {
  absl::ConsumePrefix(&csv, "\xEF\xBB\xBF");  // a mark that some programs write first
  Columns columns;
  int64_t rows = 0, number = 0;
  for (const absl::string_view text : absl::StrSplit(csv, '\n')) {
    const std::string line = absl::StrCat("line ", ++number);
    if (absl::StripAsciiWhitespace(text).empty()) continue;
    const absl::Status read = columns.empty() ? ReadHeader(line, CellsOf(text), grid, columns)
                                              : ReadRow(line, CellsOf(text), columns, grid);
    if (!read.ok()) return read;
    if (rows++ > kMaxListLength) {
      return Wrong("has too many rows; permitted: 1 to ", kMaxListLength);
    }
  }
  if (rows == 0) return Wrong("is empty; its first line names the parameters");
  return rows == 1 ? Wrong("has no row below its header") : absl::OkStatus();
}

}  // namespace

absl::Status ParsePoints(const std::string& name, absl::string_view csv, v1::Grid& grid) {
  const absl::Status read = ReadTable(csv, grid);
  if (read.ok()) return read;
  return absl::InvalidArgumentError(absl::StrCat("--points ", name, ": ", read.message()));
}

}  // namespace ballpiston::client
