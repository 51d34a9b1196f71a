#include "client/output/collision_csv.h"

#include <google/protobuf/descriptor.h>

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/output/csv_row.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

using google::protobuf::FieldDescriptor;

std::vector<const FieldDescriptor*> ColumnsOfCollisions() {
  const auto& descriptor = *v1::SampleCollisionsResponse::descriptor();
  std::vector<const FieldDescriptor*> columns;
  for (int i = 0; i < descriptor.field_count(); ++i) columns.push_back(descriptor.field(i));
  return columns;
}

std::string CellOf(const v1::SampleCollisionsResponse& message, const FieldDescriptor* column,
                   int row) {
  const auto& reflection = *message.GetReflection();
  const bool is_number = column->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE;
  return is_number ? ExactText(reflection.GetRepeatedDouble(message, column, row))
                   : absl::StrCat(reflection.GetRepeatedUInt64(message, column, row));
}

}  // namespace

void PrintCollisionHeader(std::ostream& out) {
  std::vector<std::string> names;
  for (const FieldDescriptor* column : ColumnsOfCollisions()) names.push_back(column->name());
  out << CsvRow(names);
}

void PrintCollisions(const v1::SampleCollisionsResponse& message, std::ostream& out) {
  const std::vector<const FieldDescriptor*> columns = ColumnsOfCollisions();
  for (int row = 0; row < message.sample_size(); ++row) {
    std::vector<std::string> cells;
    for (const FieldDescriptor* column : columns) cells.push_back(CellOf(message, column, row));
    out << CsvRow(cells);
  }
}

}  // namespace ballpiston::client
