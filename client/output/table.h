// Tables of the fields of messages: cells, rows of CSV, and aligned text.
#pragma once

#include <google/protobuf/message.h>

#include <initializer_list>
#include <optional>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "ballpiston/v1/spec.pb.h"
#include "client/output/number_text.h"

namespace ballpiston::client {

using Cells = std::vector<std::string>;
using NumberForm = std::string (*)(double);

// The field of a message as text. `path`: its name in the proto, or names with dots between, as in
// progress.points_done. An enum value is written as on the command line, a time as
// 2026-01-31T12:00:00Z. Empty if the message lacks the field.
std::string FieldText(const google::protobuf::Message& message, const std::string& path,
                      NumberForm form = &ExactText);

Cells FieldTexts(const google::protobuf::Message& message, const Cells& paths,
                 NumberForm form = &ExactText);

// The number in an optional field.
std::optional<double> NumberIn(const google::protobuf::Message& message, const std::string& field);

// The names of all fields in the proto's order.
Cells FieldNames(const google::protobuf::Descriptor& type);

// Those that are neither messages nor lists, as the columns of a table.
Cells PlainFields(const google::protobuf::Descriptor& type);

Cells Joined(std::initializer_list<Cells> parts);

// A row of CSV (RFC 4180) with its end of line. A cell is quoted if it contains a comma, a quote or
// a line's end.
std::string CsvRow(const Cells& cells);

// ---- a point's parameters; those that the experiment does not use are absent ----

// This many significant digits. If x differs from that text by rounding alone, all digits, as in
// 0.4999999999999999.
std::string Digits(double x, int digits);
// Ten significant digits. Near 1/2 and 1/sqrt(2), the limits of rho, all digits, because the
// rounded number may be beyond the limit.
std::string TenDigits(double x);

// "rho 0.53, delta 0.2, epsilon 0.25, exponent 1", each as TenDigits.
std::string ParameterText(const v1::PointParameters& parameters);

// The names of the parameters in CSV: rho, delta, epsilon and exponent in every file, the
// others if the specification's grid has them.
Cells ParametersInCsv(const v1::Grid& grid);

// The parameters of a table: all of them; those but rho and delta are its optional columns.
Cells ParametersInTable();
std::set<std::string> OptionalParameters();

// ---- aligned text ----

// Aligned columns of text. The first row is the header. Columns of numbers are aligned right.
// Control characters are escaped, because texts of a server may change the terminal.
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
