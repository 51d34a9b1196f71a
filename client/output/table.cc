#include "client/output/table.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/timestamp.pb.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

std::string TimeText(const google::protobuf::Timestamp& time) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%SZ", absl::FromUnixSeconds(time.seconds()),
                          absl::UTCTimeZone());
}

std::string TextOf(const Message& message, const FieldDescriptor* field, NumberForm form) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return form(reflection.GetDouble(message, field));
    case FieldDescriptor::CPPTYPE_INT32:
      return absl::StrCat(reflection.GetInt32(message, field));
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection.GetBool(message, field) ? "true" : "false";
    case FieldDescriptor::CPPTYPE_ENUM:
      return Spelling(*field->enum_type(), reflection.GetEnumValue(message, field));
    case FieldDescriptor::CPPTYPE_STRING:
      return reflection.GetString(message, field);
    default:
      return TimeText(
          dynamic_cast<const google::protobuf::Timestamp&>(reflection.GetMessage(message, field)));
  }
}

std::string CsvCell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

// The number of characters, not of bytes. In UTF-8 all bytes of a character but the first begin
// with the bits 10.
size_t Width(const std::string& text) {
  return static_cast<size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) >> 6) != 2; }));
}

// The text with its control characters as \x1b. In UTF-8 those from U+0080 to U+009F begin with c2.
std::string Escaped(absl::string_view text) {
  std::string escaped;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool has_two = text[i] == '\xc2' && i + 1 < text.size() && text[i + 1] < '\xa0';
    const auto c = static_cast<unsigned char>(text[has_two ? ++i : i]);
    if (has_two || absl::ascii_iscntrl(c)) {
      absl::StrAppend(&escaped, "\\x", absl::Hex(c, absl::kZeroPad2));
    } else {
      escaped += text[i];
    }
  }
  return escaped;
}

}  // namespace

std::string FieldText(const Message& message, const std::string& path, NumberForm form) {
  const size_t dot = path.find('.');
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(path.substr(0, dot));
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  if (dot != std::string::npos) {
    return FieldText(reflection.GetMessage(message, field), path.substr(dot + 1), form);
  }
  if (field->has_presence() && !reflection.HasField(message, field)) return "";
  return TextOf(message, field, form);
}

Cells FieldTexts(const Message& message, const Cells& paths, NumberForm form) {
  Cells cells;
  for (const std::string& path : paths) cells.push_back(FieldText(message, path, form));
  return cells;
}

std::optional<double> NumberIn(const Message& message, const std::string& name) {
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(name);
  if (!message.GetReflection()->HasField(message, field)) return std::nullopt;
  return message.GetReflection()->GetDouble(message, field);
}

Cells FieldNames(const google::protobuf::Descriptor& type) {
  Cells names;
  for (int i = 0; i < type.field_count(); ++i) names.push_back(type.field(i)->name());
  return names;
}

Cells PlainFields(const google::protobuf::Descriptor& type) {
  Cells names = FieldNames(type);
  std::erase_if(names, [&type](const std::string& name) {
    const FieldDescriptor* const field = type.FindFieldByName(name);
    return field->is_repeated() || field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
  });
  return names;
}

Cells Joined(std::initializer_list<Cells> parts) {
  Cells joined;
  for (const Cells& part : parts) joined.insert(joined.end(), part.begin(), part.end());
  return joined;
}

std::string CsvRow(const Cells& cells) {
  return absl::StrCat(
      absl::StrJoin(cells, ",",
                    [](std::string* row, const std::string& cell) { row->append(CsvCell(cell)); }),
      "\n");
}

std::string TenDigits(double x) {
  constexpr double kRounding = 1e-10;
  for (const double limit_of_rho : {0.5, std::numbers::sqrt2 / 2}) {
    if (std::abs(x - limit_of_rho) < kRounding) return ExactText(x);
  }
  return Digits(x, 10);
}

std::string Digits(double x, int digits) {
  std::string text = absl::StrFormat("%.*g", digits, x);
  double read = x;
  const bool seems_exact =
      absl::SimpleAtod(text, &read) && std::abs(read - x) < 1e-14 * std::abs(x);
  return seems_exact && read != x ? ExactText(x) : text;
}

std::string ParameterText(const v1::PointParameters& parameters) {
  Cells texts;
  for (const std::string& name : FieldNames(*v1::PointParameters::descriptor())) {
    const std::string value = FieldText(parameters, name, &TenDigits);
    if (!value.empty()) texts.push_back(absl::StrCat(name, " ", value));
  }
  return absl::StrJoin(texts, ", ");
}

Cells ParametersInCsv(const v1::Grid& grid) {
  const std::set<std::string> always = {"rho", "delta", "epsilon", "exponent"};
  Cells names = FieldNames(*v1::PointParameters::descriptor());
  std::erase_if(names, [&](const std::string& name) {
    const auto* const list = v1::Grid::descriptor()->FindFieldByName(name);
    return !always.contains(name) && grid.GetReflection()->FieldSize(grid, list) == 0;
  });
  return names;
}

Cells ParametersInTable() { return FieldNames(*v1::PointParameters::descriptor()); }

std::set<std::string> OptionalParameters() {
  const Cells names = ParametersInTable();
  std::set<std::string> optional(names.begin(), names.end());
  optional.erase("rho");
  optional.erase("delta");
  return optional;
}

TextTable::TextTable(std::vector<std::string> titles, std::set<std::string> left,
                     const std::set<std::string>& optional)
    : left_(std::move(left)), widths_(titles.size(), 0), is_shown_(titles.size()) {
  AddRow(titles);
  for (size_t i = 0; i < titles.size(); ++i) is_shown_[i] = !optional.contains(titles[i]);
}

void TextTable::AddRow(std::vector<std::string> row) {
  row.resize(widths_.size());
  for (size_t i = 0; i < row.size(); ++i) {
    row[i] = Escaped(row[i]);
    widths_[i] = std::max(widths_[i], Width(row[i]));
    if (!row[i].empty()) is_shown_[i] = true;
  }
  rows_.push_back({.cells = std::move(row), .line = ""});
}

void TextTable::AddLine(const std::string& text) {
  rows_.push_back({.cells = {}, .line = Escaped(text)});
}

std::string TextTable::Line(const Row& row, size_t indent) const {
  std::string line = std::string(indent, ' ') + row.line;
  const char* separator = "";
  for (size_t i = 0; i < row.cells.size(); ++i) {
    if (!is_shown_[i]) continue;
    const std::string& cell = row.cells[i];
    const std::string padding(widths_[i] - Width(cell), ' ');
    const bool left = left_.contains(rows_[0].cells[i]);
    absl::StrAppend(&line, separator, left ? "" : padding, cell, left ? padding : "");
    separator = "  ";
  }
  absl::StripTrailingAsciiWhitespace(&line);
  return line;
}

void TextTable::Print(std::ostream& out, size_t indent) const {
  for (const Row& row : rows_) out << Line(row, indent) << '\n';
}

}  // namespace ballpiston::client
