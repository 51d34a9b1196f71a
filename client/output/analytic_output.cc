#include "client/output/analytic_output.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <string>
#include <utility>

#include "absl/strings/str_format.h"
#include "client/output/csv_row.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using Cells = std::vector<std::string>;

// Each number field of a message is a column, in the proto's order.
std::vector<const FieldDescriptor*> Columns(const google::protobuf::Descriptor& descriptor) {
  std::vector<const FieldDescriptor*> columns;
  for (int i = 0; i < descriptor.field_count(); ++i) {
    const FieldDescriptor* field = descriptor.field(i);
    const bool is_number = field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE;
    if (is_number && !field->is_repeated()) columns.push_back(field);
  }
  return columns;
}

template <typename Type>
Cells Names() {
  Cells names;
  for (const FieldDescriptor* column : Columns(*Type::descriptor()))
    names.push_back(column->name());
  return names;
}

Cells Values(const Message& message, std::string (*text)(double)) {
  Cells cells;
  for (const FieldDescriptor* column : Columns(*message.GetDescriptor())) {
    cells.push_back(text(message.GetReflection()->GetDouble(message, column)));
  }
  return cells;
}

Cells Joined(Cells cells, const Cells& more, const Cells& still_more) {
  cells.insert(cells.end(), more.begin(), more.end());
  cells.insert(cells.end(), still_more.begin(), still_more.end());
  return cells;
}

void PrintCsv(const v1::EvaluatePairsResponse& response, std::ostream& out) {
  const Cells energies = Names<v1::EnergyAnalytics>(), averages = Names<v1::CanonicalAnalytics>();
  const Cells no_energy(energies.size()), no_averages(averages.size());
  out << CsvRow(Joined(Names<v1::PairAnalytics>(), energies, averages));
  for (const v1::PairAnalytics& pair : response.points()) {
    const Cells cells = Values(pair, &ExactText);
    if (pair.energies().empty() && pair.canonical().empty()) {
      out << CsvRow(Joined(cells, no_energy, no_averages));
    }
    for (const auto& energy : pair.energies()) {
      out << CsvRow(Joined(cells, Values(energy, &ExactText), no_averages));
    }
    for (const auto& row : pair.canonical()) {
      out << CsvRow(Joined(cells, no_energy, Values(row, &ExactText)));
    }
  }
}

std::string TableCell(double x) { return Measured(x, 0).value; }

void PrintQuantities(const v1::PairAnalytics& pair, std::ostream& out) {
  TextTable table({{"quantity", TextTable::Column::kLeft}, {"value", TextTable::Column::kLeft}});
  const Cells names = Names<v1::PairAnalytics>(), values = Values(pair, &TableCell);
  for (size_t i = 0; i < names.size(); ++i) table.AddRow({names[i], values[i]});
  table.Print(out);
}

TextTable TableOf(const Cells& titles) {
  std::vector<TextTable::Column> columns;
  for (const std::string& title : titles) columns.push_back({title});
  return TextTable(columns);
}

void PrintEnergies(const v1::PairAnalytics& pair, const std::vector<double>& outgoing,
                   std::ostream& out) {
  Cells titles = Names<v1::EnergyAnalytics>();
  for (const double energy : outgoing) titles.push_back(absl::StrFormat("W(%g)", energy));
  TextTable table = TableOf(titles);
  for (const v1::EnergyAnalytics& energy : pair.energies()) {
    Cells cells = Values(energy, &TableCell);
    for (const double w : energy.kernel()) cells.push_back(TableCell(w));
    table.AddRow(std::move(cells));
  }
  out << '\n';
  table.Print(out, 2);
}

void PrintCanonical(const v1::PairAnalytics& pair, std::ostream& out) {
  TextTable table = TableOf(Names<v1::CanonicalAnalytics>());
  for (const auto& row : pair.canonical()) table.AddRow(Values(row, &TableCell));
  out << '\n';
  table.Print(out, 2);
}

void PrintTable(const v1::EvaluatePairsResponse& response, const std::vector<double>& outgoing,
                std::ostream& out) {
  const char* separator = "";
  for (const v1::PairAnalytics& pair : response.points()) {
    out << separator;
    separator = "\n";
    PrintQuantities(pair, out);
    if (!pair.energies().empty()) PrintEnergies(pair, outgoing, out);
    if (!pair.canonical().empty()) PrintCanonical(pair, out);
  }
}

}  // namespace

void PrintAnalytics(const v1::EvaluatePairsResponse& response,
                    const std::vector<double>& outgoing_epsilon, Format format, std::ostream& out) {
  switch (format) {
    case Format::kTable:
      return PrintTable(response, outgoing_epsilon, out);
    case Format::kJson:
      return PrintJsonDocument("points", response.points(), out);
    case Format::kJsonl:
      return PrintJsonLines(response.points(), out);
    case Format::kCsv:
    case Format::kCsvHistograms:
    case Format::kCsvCurves:
      return PrintCsv(response, out);
  }
}

}  // namespace ballpiston::client
