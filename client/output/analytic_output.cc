#include <string>

#include "absl/strings/str_cat.h"
#include "client/output/answers.h"
#include "client/output/field_text.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

Cells KernelTitles(const std::vector<double>& outgoing) {
  Cells titles;
  for (const double energy : outgoing) titles.push_back(absl::StrCat("W(", ExactText(energy), ")"));
  return titles;
}

void PrintCsv(const v1::EvaluatePairsResponse& response, const std::vector<double>& outgoing,
              std::ostream& out) {
  const Cells pairs = PlainFields(*v1::PairAnalytics::descriptor()),
              energies = PlainFields(*v1::EnergyAnalytics::descriptor()),
              averages = PlainFields(*v1::CanonicalAnalytics::descriptor());
  const Cells no_energy(energies.size() + outgoing.size()), no_averages(averages.size());
  out << CsvRow(Joined({pairs, energies, KernelTitles(outgoing), averages}));
  for (const v1::PairAnalytics& pair : response.points()) {
    const Cells cells = FieldTexts(pair, pairs);
    if (pair.energies().empty() && pair.canonical().empty()) {
      out << CsvRow(Joined({cells, no_energy, no_averages}));
    }
    for (const auto& energy : pair.energies()) {
      Cells kernel;
      for (const double w : energy.kernel()) kernel.push_back(ExactText(w));
      out << CsvRow(Joined({cells, FieldTexts(energy, energies), kernel, no_averages}));
    }
    for (const auto& row : pair.canonical()) {
      out << CsvRow(Joined({cells, no_energy, FieldTexts(row, averages)}));
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

// A row for each message, with its kernel if it has one.
template <typename Rows>
void PrintRows(const Rows& rows, const Cells& kernel_titles, std::ostream& out) {
  if (rows.empty()) return;
  const Cells columns = PlainFields(*rows[0].GetDescriptor());
  TextTable table(Joined({columns, kernel_titles}));
  for (const auto& row : rows) {
    Cells cells = TableCells(row, columns);
    if constexpr (requires { row.kernel(); }) {
      for (const double w : row.kernel()) cells.push_back(TableCell(w));
    }
    table.AddRow(cells);
  }
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
    PrintRows(pair.energies(), KernelTitles(outgoing), out);
    PrintRows(pair.canonical(), {}, out);
  }
}

}  // namespace

void PrintAnalytics(const v1::EvaluatePairsResponse& response,
                    const std::vector<double>& outgoing_epsilon, Format format, std::ostream& out) {
  if (format == Format::kTable) return PrintTable(response, outgoing_epsilon, out);
  if (format == Format::kCsv) return PrintCsv(response, outgoing_epsilon, out);
  if (format == Format::kJsonl) return PrintJsonLines(response.points(), out);
  PrintJsonDocument("points", response.points(), out);
}

}  // namespace ballpiston::client
