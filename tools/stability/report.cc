#include "tools/stability/report.h"

#include <cstdint>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "tools/stability/ball_cases.h"
#include "tools/stability/ball_methods.h"
#include "tools/stability/cancellation.h"
#include "tools/stability/energy_drift.h"
#include "tools/stability/gas_cases.h"
#include "tools/stability/gas_energy.h"
#include "tools/stability/gas_methods.h"
#include "tools/stability/model_errors.h"
#include "tools/stability/pair_cases.h"
#include "tools/stability/pair_methods.h"
#include "tools/stability/reversal.h"
#include "tools/stability/stability_tables.h"
#include "tools/stability/unit_speed.h"

namespace ballpiston::stability {
namespace {

struct Results {
  std::vector<CaseResult> ball;
  std::vector<CaseResult> pair;
  std::vector<CaseResult> gas;
  std::vector<Reversal> ball_reversals;
  std::vector<Reversal> pair_reversals;
  std::vector<EnergyRun> energy;
  std::vector<GasEnergyRun> gas_energy;
  std::vector<ModelError> model_errors;
  std::vector<Cancellation> cancellations;
  std::vector<uint64_t> unit_speed;
};

template <typename Case, typename Method>
std::vector<CaseResult> RunAll(const std::vector<Case>& cases, const std::vector<Method>& methods,
                               Failures (*run)(const Case&, const Method&, double), double effort) {
  std::vector<CaseResult> results;
  for (const Case& one : cases) {
    std::cerr << "stability: " << one.name << std::endl;
    CaseResult result = {.name = one.name, .methods = {}};
    for (const Method& method : methods) {
      result.methods.push_back({method.name, method.promised, run(one, method, effort)});
    }
    results.push_back(result);
  }
  return results;
}

Results RunAll(double effort) {
  Results results;
  results.ball = RunAll(BallCases(), BallMethods(), FlyCase, effort);
  results.pair = RunAll(PairCases(), PairMethods(), RunCase, effort);
  results.gas = RunAll(GasCases(), GasMethods(), RunGasCase, effort);
  std::cerr << "stability: reversal" << std::endl;
  const uint64_t orbits = effort < 1 ? 100 : 1000;
  results.ball_reversals = BallReversals(orbits);
  results.pair_reversals = PairReversals(20 * orbits);
  std::cerr << "stability: energy" << std::endl;
  results.energy = EnergyRuns(effort);
  results.gas_energy = GasEnergyRuns(effort);
  if (effort == 1) results.model_errors = ModelErrors();  // fewer samples show nothing
  results.cancellations = Cancellations();
  results.unit_speed = HitsBeforeEscape(40);
  return results;
}

// One sentence for each broken promise.
std::vector<std::string> BrokenPromises(const Results& results) {
  std::vector<std::string> broken;
  for (const auto* cases : {&results.ball, &results.pair, &results.gas}) {
    for (const CaseResult& result : *cases) {
      for (const MethodResult& m : result.methods) {
        if (!m.promised || m.failures.Total() == 0) continue;
        broken.push_back(absl::StrCat(m.method, " fails: ", result.name));
      }
    }
  }
  for (const EnergyRun& run : results.energy) {
    if (!run.promised || (run.record.Worst() <= 1e-14 && !Drifts(run))) continue;
    broken.push_back(absl::StrCat(run.method, " loses energy: ", run.what));
  }
  for (const GasEnergyRun& run : results.gas_energy) {
    if (run.promised && LosesEnergy(run)) {
      broken.push_back(absl::StrCat(run.method, " loses energy: gases"));
    }
  }
  for (const std::string& claim : BrokenClaims(results.model_errors)) broken.push_back(claim);
  return broken;
}

// A zero proves something only if the same check has found failures of other methods.
std::vector<std::string> BlindLooks(const Results& results) {
  Failures all;
  for (const auto* cases : {&results.ball, &results.pair, &results.gas}) {
    for (const CaseResult& result : *cases) {
      for (const MethodResult& m : result.methods) all.Merge(m.failures);
    }
  }
  std::vector<std::string> blind;
  const auto look = [&blind](uint64_t count, const char* what) {
    if (count == 0) blind.push_back(absl::StrCat("no method showed any ", what));
  };
  look(all.escapes, "escape");
  look(all.negative_times, "negative time");
  look(all.loops, "loop");
  look(all.inward, "hit that leaves the ball heading inward");
  look(all.missed, "missed piston");
  look(all.beyond_walls, "piston beyond its wall");
  return blind;
}

std::string Text(const Results& results) {
  const std::vector<uint64_t>& unit_speed = results.unit_speed;
  return absl::StrCat(
      "Made by the program `stability`; what is counted, and how: `tools/stability/README.md`. "
      "e escapes, n negative times, l loops, i still heading inward, m missed piston hits, "
      "p phantom ones, b pistons beyond their walls; - not run.\n\n**The ball alone**\n\n",
      SummaryTable(results.ball), "\n**Ball and piston**\n\n", SummaryTable(results.pair),
      "\n**The gas**\n\n", SummaryTable(results.gas),
      "\nOrbits whose hit times assume unit speed leave the cell after ",
      unit_speed[unit_speed.size() / 2], " hits (median of ", unit_speed.size(),
      " starts at the paper's radius; ", unit_speed.front(), " at the earliest, ",
      unit_speed.back(), " at the latest).\n\n**Energy**\n\n", EnergyTable(results.energy),
      "\nGases of 4x3 cells:\n\n", GasEnergyTable(results.gas_energy),
      "\n**Model errors**: billiard over model - 1, and the error that is stated; ratio: (the "
      "difference - 2 standard errors)/stated, - where the standard error is above half of the "
      "stated error\n\n",
      ModelErrorTable(results.model_errors),
      "\n**Reversal**: distance from the start, in cells, after so many hits and as many back; "
      "medians\n\n",
      ReversalTable(results.ball_reversals, results.pair_reversals),
      "\n**Closed forms where they cancel**: relative errors\n\n",
      CancellationTable(results.cancellations),
      "\n<details><summary>All counts: the ball alone</summary>\n\n", BallTable(results.ball),
      "\n</details>\n\n<details><summary>All counts: ball and piston</summary>\n\n",
      PairTable(results.pair),
      "\n</details>\n\n<details><summary>All counts: the gas</summary>\n\n", GasTable(results.gas),
      "\n</details>\n");
}

}  // namespace

Report MakeReport(double effort) {
  const Results results = RunAll(effort);
  Report report = {.text = Text(results), .complaints = BrokenPromises(results)};
  for (const std::string& blind : BlindLooks(results)) report.complaints.push_back(blind);
  return report;
}

}  // namespace ballpiston::stability
