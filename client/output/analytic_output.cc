#include "client/output/analytic_output.h"

#include <google/protobuf/descriptor.h>

#include <string>
#include <utility>

#include "absl/strings/str_format.h"
#include "client/output/csv_row.h"
#include "client/output/field_text.h"
#include "client/output/json.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

// The fields that are columns: all but the lists, which have tables of their own.
template <typename Type>
Cells Columns() {
  const google::protobuf::Descriptor& type = *Type::descriptor();
  Cells names = FieldNames(type);
  std::erase_if(names, [&type](const std::string& name) {
    return type.FindFieldByName(name)->is_repeated();
  });
  return names;
}

void PrintCsv(const v1::EvaluatePairsResponse& response, std::ostream& out) {
  const Cells pairs = Columns<v1::PairAnalytics>(), energies = Columns<v1::EnergyAnalytics>(),
              averages = Columns<v1::CanonicalAnalytics>();
  const Cells no_energy(energies.size()), no_averages(averages.size());
  out << CsvRow(Joined(Joined(pairs, energies), averages));
  for (const v1::PairAnalytics& pair : response.points()) {
    const Cells cells = FieldTexts(pair, pairs);
    if (pair.energies().empty() && pair.canonical().empty()) {
      out << CsvRow(Joined(Joined(cells, no_energy), no_averages));
    }
    for (const auto& energy : pair.energies()) {
      out << CsvRow(Joined(Joined(cells, FieldTexts(energy, energies)), no_averages));
    }
    for (const auto& row : pair.canonical()) {
      out << CsvRow(Joined(Joined(cells, no_energy), FieldTexts(row, averages)));
    }
  }
}

std::string TableCell(double x) { return Measured(x, 0).value; }

void PrintQuantities(const v1::PairAnalytics& pair, std::ostream& out) {
  TextTable table({"quantity", "value"}, {"quantity", "value"});
  for (const std::string& name : Columns<v1::PairAnalytics>()) {
    table.AddRow({name, FieldText(pair, name, &TableCell)});
  }
  table.Print(out);
}

void PrintEnergies(const v1::PairAnalytics& pair, const std::vector<double>& outgoing,
                   std::ostream& out) {
  const Cells columns = Columns<v1::EnergyAnalytics>();
  Cells titles = columns;
  for (const double energy : outgoing) titles.push_back(absl::StrFormat("W(%g)", energy));
  TextTable table(titles);
  for (const v1::EnergyAnalytics& energy : pair.energies()) {
    Cells cells = FieldTexts(energy, columns, &TableCell);
    for (const double w : energy.kernel()) cells.push_back(TableCell(w));
    table.AddRow(std::move(cells));
  }
  out << '\n';
  table.Print(out, 2);
}

void PrintCanonical(const v1::PairAnalytics& pair, std::ostream& out) {
  const Cells columns = Columns<v1::CanonicalAnalytics>();
  TextTable table(columns);
  for (const auto& row : pair.canonical()) table.AddRow(FieldTexts(row, columns, &TableCell));
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
    default:
      return PrintCsv(response, out);
  }
}

}  // namespace ballpiston::client
