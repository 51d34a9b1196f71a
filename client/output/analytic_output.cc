#include <string>
#include <utility>

#include "absl/strings/str_format.h"
#include "client/output/answers.h"
#include "client/output/field_text.h"
#include "client/output/json.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

void PrintCsv(const v1::EvaluatePairsResponse& response, std::ostream& out) {
  const Cells pairs = PlainFields(*v1::PairAnalytics::descriptor()),
              energies = PlainFields(*v1::EnergyAnalytics::descriptor()),
              averages = PlainFields(*v1::CanonicalAnalytics::descriptor());
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

std::string ParameterCell(double x) { return Digits(x, 12); }

Cells TableCells(const google::protobuf::Message& row, const Cells& columns) {
  Cells cells;
  for (const std::string& name : columns) {
    const bool is_parameter = v1::PointParameters::descriptor()->FindFieldByName(name) != nullptr;
    cells.push_back(FieldText(row, name, is_parameter ? &ParameterCell : &TableCell));
  }
  return cells;
}

void PrintQuantities(const v1::PairAnalytics& pair, std::ostream& out) {
  TextTable table({"quantity", "value"}, {"quantity", "value"});
  const Cells names = PlainFields(*v1::PairAnalytics::descriptor()),
              values = TableCells(pair, names);
  for (size_t i = 0; i < names.size(); ++i) table.AddRow({names[i], values[i]});
  table.Print(out);
}

void PrintEnergies(const v1::PairAnalytics& pair, const std::vector<double>& outgoing,
                   std::ostream& out) {
  const Cells columns = PlainFields(*v1::EnergyAnalytics::descriptor());
  Cells titles = columns;
  for (const double energy : outgoing) titles.push_back(absl::StrFormat("W(%g)", energy));
  TextTable table(titles);
  for (const v1::EnergyAnalytics& energy : pair.energies()) {
    Cells cells = TableCells(energy, columns);
    for (const double w : energy.kernel()) cells.push_back(TableCell(w));
    table.AddRow(std::move(cells));
  }
  out << '\n';
  table.Print(out, 2);
}

void PrintCanonical(const v1::PairAnalytics& pair, std::ostream& out) {
  const Cells columns = PlainFields(*v1::CanonicalAnalytics::descriptor());
  TextTable table(columns);
  for (const auto& row : pair.canonical()) table.AddRow(TableCells(row, columns));
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
