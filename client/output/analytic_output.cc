#include "client/output/analytic_output.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

using Pair = v1::PairAnalytics;
using Energy = v1::EnergyAnalytics;
using Canonical = v1::CanonicalAnalytics;

struct PairColumn {
  const char* name;
  double (Pair::*value)() const;
};

// The reference table's columns in its order; the bounds are printed after the energies' in CSV, so
// that what both tables have comes first.
constexpr PairColumn kPairColumns[] = {{"rho", &Pair::rho},
                                       {"delta", &Pair::delta},
                                       {"lambda", &Pair::lambda},
                                       {"eta", &Pair::eta},
                                       {"cell_area", &Pair::cell_area},
                                       {"volume", &Pair::volume},
                                       {"area_ball_piston", &Pair::area_ball_piston},
                                       {"area_ball_wall", &Pair::area_ball_wall},
                                       {"area_piston_wall", &Pair::area_piston_wall},
                                       {"tau_ball_piston", &Pair::tau_ball_piston},
                                       {"tau_ball_wall", &Pair::tau_ball_wall},
                                       {"tau_piston_wall", &Pair::tau_piston_wall}};
constexpr PairColumn kBoundColumns[] = {{"pair_delta_bound", &Pair::pair_delta_bound},
                                        {"gas_delta_bound", &Pair::gas_delta_bound},
                                        {"rare_limit_rate", &Pair::rare_limit_rate}};

struct EnergyColumn {
  const char* name;
  double (Energy::*value)() const;
};

constexpr EnergyColumn kEnergyColumns[] = {
    {"epsilon", &Energy::epsilon},
    {"phi", &Energy::phi},
    {"f", &Energy::f},
    {"j", &Energy::j},
    {"h", &Energy::h},
    {"mean_free_time_conditional", &Energy::mean_free_time_conditional}};

struct CanonicalColumn {
  const char* name;
  double (Canonical::*value)() const;
};

constexpr CanonicalColumn kCanonicalColumns[] = {
    {"beta", &Canonical::beta},
    {"temperature", &Canonical::temperature},
    {"mean_f", &Canonical::mean_f},
    {"mean_energy_current", &Canonical::mean_energy_current},
    {"mean_h", &Canonical::mean_h},
    {"exchange_rate", &Canonical::exchange_rate},
    {"static_conductivity", &Canonical::static_conductivity},
    {"rare_limit_exchange_rate", &Canonical::rare_limit_exchange_rate}};

template <typename Columns>
void AppendNames(const Columns& columns, std::vector<std::string>& cells) {
  for (const auto& column : columns) cells.push_back(column.name);
}

// Without a message the cells stay empty.
template <typename Columns, typename Message>
void AppendValues(const Columns& columns, const Message* message, std::vector<std::string>& cells) {
  for (const auto& column : columns) {
    cells.push_back(message == nullptr ? "" : ExactText((message->*column.value)()));
  }
}

std::string CsvRow(const Pair& pair, const Energy* energy, const Canonical* canonical) {
  std::vector<std::string> cells;
  AppendValues(kPairColumns, &pair, cells);
  AppendValues(kEnergyColumns, energy, cells);
  AppendValues(kBoundColumns, &pair, cells);
  AppendValues(kCanonicalColumns, canonical, cells);
  return absl::StrCat(absl::StrJoin(cells, ","), "\n");
}

void PrintCsv(const v1::EvaluatePairsResponse& response, std::ostream& out) {
  std::vector<std::string> names;
  AppendNames(kPairColumns, names);
  AppendNames(kEnergyColumns, names);
  AppendNames(kBoundColumns, names);
  AppendNames(kCanonicalColumns, names);
  out << absl::StrJoin(names, ",") << '\n';
  for (const Pair& pair : response.points()) {
    if (pair.energies().empty() && pair.canonical().empty()) out << CsvRow(pair, nullptr, nullptr);
    for (const Energy& energy : pair.energies()) out << CsvRow(pair, &energy, nullptr);
    for (const Canonical& row : pair.canonical()) out << CsvRow(pair, nullptr, &row);
  }
}

std::string TableCell(double x) { return absl::StrFormat("%.15g", x); }

void PrintQuantities(const Pair& pair, std::ostream& out) {
  TextTable table({{"quantity", TextTable::Column::kLeft}, {"value", TextTable::Column::kLeft}});
  const auto add = [&](const PairColumn& column) {
    table.AddRow({column.name, TableCell((pair.*column.value)())});
  };
  for (const PairColumn& column : kPairColumns) add(column);
  for (const PairColumn& column : kBoundColumns) add(column);
  table.Print(out);
}

template <typename Columns, typename Message>
std::vector<std::string> TableCells(const Columns& columns, const Message& message) {
  std::vector<std::string> cells;
  for (const auto& column : columns) cells.push_back(TableCell((message.*column.value)()));
  return cells;
}

void PrintEnergies(const Pair& pair, const std::vector<double>& outgoing, std::ostream& out) {
  std::vector<TextTable::Column> columns;
  for (const EnergyColumn& column : kEnergyColumns) columns.push_back({column.name});
  for (const double energy : outgoing) columns.push_back({absl::StrFormat("W(%g)", energy)});
  TextTable table(columns);
  for (const Energy& energy : pair.energies()) {
    std::vector<std::string> cells = TableCells(kEnergyColumns, energy);
    for (const double w : energy.kernel()) cells.push_back(TableCell(w));
    table.AddRow(std::move(cells));
  }
  out << '\n';
  table.Print(out, 2);
}

void PrintCanonical(const Pair& pair, std::ostream& out) {
  std::vector<TextTable::Column> columns;
  for (const CanonicalColumn& column : kCanonicalColumns) columns.push_back({column.name});
  TextTable table(columns);
  for (const Canonical& row : pair.canonical()) table.AddRow(TableCells(kCanonicalColumns, row));
  out << '\n';
  table.Print(out, 2);
}

void PrintTable(const v1::EvaluatePairsResponse& response, const std::vector<double>& outgoing,
                std::ostream& out) {
  const char* separator = "";
  for (const Pair& pair : response.points()) {
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
      return PrintCsv(response, out);
  }
}

}  // namespace ballpiston::client
