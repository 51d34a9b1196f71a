// Computes the stability tables: the failures of every engine in every precision, and of the naive
// methods, in each situation. kHelp has the arguments and the exit status. Complaints come
// after the tables. There is one for each broken promise of an engine (no failures, no loss of
// energy), and one for each kind of failure that no method shows, because its zeros prove nothing.
#include <algorithm>
#include <cstdint>
#include <exception>
#include <iostream>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/closed_form/pair_measures.h"
#include "core/geometry/pair_geometry.h"
#include "tools/flows/paper.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"
#include "tools/stability/case.h"
#include "tools/stability/markdown_table.h"
#include "tools/stability/model_errors.h"
#include "tools/stability/results.h"
#include "tools/stability/starts.h"
#include "tools/stability/textbook_flow.h"

namespace ballpiston::stability {
namespace {

// ---- closed forms at parameters where terms of the printed formulas cancel ----

// A row with the relative errors of one measure by the printed formulas in double and by the
// library. The exact value has 113 bits, which leave enough bits after the cancellation.
template <typename Measure>
std::vector<std::string> ErrorsOf(const char* name, const Measure& measure,
                                  const std::string& where, const PairGeometry& geometry) {
  const double rho = geometry.rho(), delta = geometry.delta();
  const Quad exact = measure(MeasuresAsPrinted<Quad>(rho, delta, QuadPi()));
  const double printed = measure(MeasuresAsPrinted(rho, delta, std::numbers::pi));
  return {name, where, ErrorText(RelativeError(printed, exact)),
          ErrorText(RelativeError(measure(Measures(geometry)), exact))};
}

// Relative errors of the printed formulas, evaluated in double, and of core/closed_form.
std::string CancellationTable() {
  Rows rows = {{"quantity", "where", "as printed", "core/closed_form"}};
  const auto eta = [](const auto& measures) { return measures.eta; };
  const auto cell = [](const auto& measures) { return measures.cell_area; };
  const auto ball_wall = [](const auto& measures) { return measures.area_ball_wall; };
  const auto ball_piston = [](const auto& measures) { return measures.area_ball_piston; };
  for (const double delta : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const PairGeometry geometry = *PairGeometry::Create(kPaperRho, delta);
    const std::string where = absl::StrCat("rho = 0.5296, delta = ", delta);
    rows.push_back(ErrorsOf("dG_bp", ball_piston, where, geometry));
    rows.push_back(ErrorsOf("eta", eta, where, geometry));
  }
  for (const double distance : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const double rho = kMaxRho - distance;
    const PairGeometry geometry = *PairGeometry::Create(rho, 0.5 * PairDeltaBound(rho));
    const std::string where =
        absl::StrCat("1/sqrt 2 - rho = ", distance, ", delta = half its bound");
    rows.push_back(ErrorsOf("cell", cell, where, geometry));
    rows.push_back(ErrorsOf("dG_bw", ball_wall, where, geometry));
    rows.push_back(ErrorsOf("eta", eta, where, geometry));
  }
  return MarkdownTable(rows, 2);
}

// ---- the lifetime of an orbit whose hit times assume |v| = 1 while its reflections do not ----

uint64_t HitsBeforeEscape(const PairGeometry& geometry, const PairState& start) {
  constexpr double kGone = 1e-3;  // depth inside a disc, in cells; far above rounding errors
  TextbookFlow<TextbookRule::kUnitSpeed> flow(geometry, start);
  for (uint64_t hits = 0;; ++hits) {
    const bool is_lost = flow.Step().kind == EventKind::kEscape;
    if (is_lost || !InsideCell(geometry, flow.state().position, kGone)) return hits;
  }
}

// The numbers of wall hits before the escape, for 40 orbits at the paper's radius.
std::string UnitSpeedSentence() {
  constexpr uint64_t kUnitSpeedSeed = 24, kOrbits = 40;
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.1);
  std::vector<uint64_t> hits;
  for (uint64_t i = 0; i < kOrbits; ++i) {
    CounterRandom random(kUnitSpeedSeed, 0, i);
    hits.push_back(HitsBeforeEscape(geometry, AnywhereOnWall(geometry, random)));
  }
  std::sort(hits.begin(), hits.end());
  return absl::StrCat("Orbits whose hit times assume unit speed leave the cell after ",
                      hits[kOrbits / 2], " hits (median of ", kOrbits,
                      " starts at the paper's radius; ", hits.front(), " at the earliest, ",
                      hits.back(), " at the latest).");
}

// ---- all tables ----

// `effort` is the fraction of the starts; 1 takes minutes. Prints progress on standard error.
Results RunAll(double effort) {
  Results results;
  results.systems = {
      {"The ball alone",
       RunCases(BallCases(), BallMethods(), effort),
       {&Failures::looked_back, &Failures::missed, &Failures::phantoms, &Failures::beyond_walls}},
      {"Ball and piston", RunCases(PairCases(), PairMethods(), effort), {&Failures::beyond_walls}},
      {"The gas", RunCases(GasCases(), GasMethods(), effort), {}}};
  if (effort == 1) results.model_errors = ModelErrors();  // fewer samples show nothing
  return results;
}

std::string Text(const Results& results) {
  std::string summaries, counts;
  for (const System& system : results.systems) {
    absl::StrAppend(&summaries, "**", system.title, "**\n\n", SummaryTable(system), "\n");
    absl::StrAppend(&counts,
                    "\n<details><summary>All counts: ", absl::AsciiStrToLower(system.title),
                    "</summary>\n\n", CountTable(system), "\n</details>\n");
  }
  return absl::StrCat(
      "Made by the program `stability`; what is counted, and how: `tools/stability/README.md`. "
      "e escapes, n negative times, l loops, i still heading inward, m missed piston hits, "
      "p phantom ones, b pistons beyond their walls; - not run or not looked for.\n\n",
      summaries, UnitSpeedSentence(), "\n\n**Energy**\n\n", EnergyTable(results.systems),
      "\n**Model errors**: billiard over model - 1, and the error that is stated; ratio: (the "
      "difference - 2 standard errors)/stated, - where the standard error is above half of the "
      "stated error\n\n",
      ModelErrorTable(results.model_errors),
      "\n**Closed forms where they cancel**: relative errors\n\n", CancellationTable(), counts);
}

// ---- the program ----

constexpr char kHelp[] =
    R"(usage: stability [--quick]

Runs every engine in every precision, and naive methods, in situations in which methods fail.
Counts the failures, measures the errors that models state, and prints tables in Markdown. This
takes about fourteen minutes on one core. The starts are fixed: the same program gives the same
tables. Progress and errors go to standard error.

  --quick      run a thousandth of the starts (of slow methods sometimes none), and no model
               errors: seconds instead of minutes
  --help       print this text

Exit status: 0 success; 1 an engine failed although it promises zeros, or a stated model error does
not hold, or no method showed one kind of failure, or the tables cannot be computed or printed;
2 wrong arguments.
tools/stability/README.md explains the counted failures.
)";

// Whether standard output took the text.
bool Print(const std::string& text) {
  std::cout << text << std::flush;
  if (!std::cout) std::cerr << "stability: cannot write to standard output\n";
  return !std::cout.fail();
}

int Run(int argc, char** argv) {
  double effort = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--help" || argument == "-h") return Print(kHelp) ? 0 : 1;
    if (argument != "--quick") {
      std::cerr << "stability: unknown argument '" << argument << "'; see stability --help\n";
      return 2;
    }
    effort = 1e-3;
  }
  const Results results = RunAll(effort);
  const bool printed = Print(Text(results));
  const std::vector<std::string> complaints = Complaints(results);
  for (const std::string& complaint : complaints) {
    std::cerr << "stability: " << complaint << "\n";
  }
  return printed && complaints.empty() ? 0 : 1;
}

}  // namespace
}  // namespace ballpiston::stability

int main(int argc, char** argv) {
  try {
    return ballpiston::stability::Run(argc, argv);
  } catch (const std::exception& failure) {
    std::cerr << "stability: cannot compute the tables: " << failure.what() << "\n";
    return 1;
  }
}
