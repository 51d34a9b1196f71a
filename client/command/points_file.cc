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
#include "client/library/quoted.h"
#include "client/output/field_text.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

using google::protobuf::FieldDescriptor;
using Columns = std::vector<const FieldDescriptor*>;
using Texts = std::vector<absl::string_view>;

class PointsReader {
 public:
  PointsReader(const std::string& name, v1::Grid& grid) : name_(name), grid_(grid) {}

  absl::Status Read(absl::string_view csv) {
    absl::ConsumePrefix(&csv, "\xEF\xBB\xBF");  // a mark that some programs write first
    size_t rows = 0, number = 0;
    for (const absl::string_view line : absl::StrSplit(csv, '\n')) {
      line_ = absl::StrCat("line ", ++number);
      if (absl::StripAsciiWhitespace(line).empty()) continue;
      const absl::Status read = columns_.empty() ? ReadHeader(Cells(line)) : ReadRow(Cells(line));
      if (!read.ok()) return read;
      if (rows++ > kMaxListLength) {
        return Bad(absl::StrCat("has too many rows; permitted: 1 to ", kMaxListLength));
      }
    }
    if (rows == 0) return Bad("is empty; its first line names the parameters");
    return rows == 1 ? Bad("has no row below its header") : absl::OkStatus();
  }

 private:
  absl::Status Bad(absl::string_view reason) const {
    return absl::InvalidArgumentError(absl::StrCat("--points ", name_, ": ", reason));
  }

  static Texts Cells(absl::string_view line) {
    Texts cells = absl::StrSplit(line, ',');
    for (absl::string_view& cell : cells) {
      cell = absl::StripAsciiWhitespace(cell);
      if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"') {
        cell = cell.substr(1, cell.size() - 2);
      }
    }
    return cells;
  }

  // The lists of a grid, except the names of the table's columns.
  static std::vector<std::string> Parameters() {
    std::vector<std::string> names = FieldNames(*v1::Grid::descriptor());
    std::erase(names, "table");
    return names;
  }

  absl::Status ReadHeader(const Texts& names) {
    const std::vector<std::string> parameters = Parameters();
    for (const absl::string_view name : names) {
      const auto found = std::find(parameters.begin(), parameters.end(), name);
      if (found == parameters.end()) {
        return Bad(absl::StrCat(line_, ": the column ", NotOneOf(name, parameters)));
      }
      const FieldDescriptor* field = v1::Grid::descriptor()->FindFieldByName(*found);
      if (std::find(columns_.begin(), columns_.end(), field) != columns_.end()) {
        return Bad(absl::StrCat(line_, ": the column ", name, " is there twice"));
      }
      if (grid_.GetReflection()->FieldSize(grid_, field) > 0) {
        return Bad(absl::StrCat("has the column ", name, ", and --", name,
                                " is given; permitted: one of them"));
      }
      columns_.push_back(field);
      grid_.add_table(*found);
    }
    return absl::OkStatus();
  }

  absl::Status ReadRow(const Texts& cells) {
    if (cells.size() != columns_.size()) {
      return Bad(absl::StrCat(line_, " has ", Counted(static_cast<double>(cells.size()), "value"),
                              "; the header names ",
                              Counted(static_cast<double>(columns_.size()), "column")));
    }
    for (size_t i = 0; i < cells.size(); ++i) {
      const absl::Status added = Add(*columns_[i], cells[i]);
      if (added.ok()) continue;
      return Bad(absl::StrCat(line_, ", column ", columns_[i]->name(), ": ", added.message()));
    }
    return absl::OkStatus();
  }

  absl::Status Add(const FieldDescriptor& column, absl::string_view text) {
    const google::protobuf::Reflection& reflection = *grid_.GetReflection();
    if (column.cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
      reflection.AddString(&grid_, &column, ShapeText(text));
      return absl::OkStatus();
    }
    const absl::StatusOr<double> number = ParseNumber(text);
    if (number.ok()) reflection.AddDouble(&grid_, &column, *number);
    return number.status();
  }

  const std::string& name_;
  v1::Grid& grid_;
  Columns columns_;
  std::string line_;  // the current one
};

}  // namespace

absl::Status ParsePoints(const std::string& name, absl::string_view csv, v1::Grid& grid) {
  return PointsReader(name, grid).Read(csv);
}

}  // namespace ballpiston::client
