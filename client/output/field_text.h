// The fields of messages as text, by their names in the proto: the cells of CSV and of tables.
#pragma once

#include <google/protobuf/message.h>

#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ballpiston/v1/spec.pb.h"
#include "client/output/number_text.h"

namespace ballpiston::client {

using Cells = std::vector<std::string>;
using NumberForm = std::string (*)(double);

// `path`: the field's name, or names with dots between, as in progress.points_done. An enum value
// is written as on the command line, a time as 2026-01-31T12:00:00Z. Empty if the message lacks the
// field.
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

}  // namespace ballpiston::client
