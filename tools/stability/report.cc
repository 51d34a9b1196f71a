#include "tools/stability/report.h"

#include <iostream>

#include "absl/strings/str_cat.h"
#include "tools/stability/cancellation.h"
#include "tools/stability/case.h"
#include "tools/stability/cases.h"
#include "tools/stability/energy.h"
#include "tools/stability/model_errors.h"
#include "tools/stability/unit_speed.h"

namespace ballpiston::stability {
namespace {

struct Results {
  std::vector<CaseResult> ball;
  std::vector<CaseResult> pair;
  std::vector<CaseResult> gas;
  std::vector<EnergyRun> energy;
  std::vector<EnergyRun> gas_energy;
  std::vector<ModelError> model_errors;
};

Results RunAll(double effort) {
  Results results;
  results.ball = RunCases(BallCases(), BallMethods(), effort);
  results.pair = RunCases(PairCases(), PairMethods(), effort);
  results.gas = RunCases(GasCases(), GasMethods(), effort);
  std::cerr << "stability: energy" << std::endl;
  results.energy = EnergyRuns(effort);
  results.gas_energy = GasEnergyRuns(effort);
  if (effort == 1) results.model_errors = ModelErrors();  // fewer samples show nothing
  return results;
}

// Calls `visit` with each case and each of its methods.
template <typename Visit>
void ForEachMethod(const Results& results, const Visit& visit) {
  for (const auto* cases : {&results.ball, &results.pair, &results.gas}) {
    for (const CaseResult& result : *cases) {
      for (const MethodResult& method : result.methods) visit(result, method);
    }
  }
}

// One sentence for each broken promise.
std::vector<std::string> BrokenPromises(const Results& results) {
  std::vector<std::string> broken;
  ForEachMethod(results, [&](const CaseResult& result, const MethodResult& method) {
    if (!method.promised || method.failures.Total() == 0) return;
    broken.push_back(absl::StrCat(method.method, " fails: ", result.name));
  });
  for (const auto* runs : {&results.energy, &results.gas_energy}) {
    for (const EnergyRun& run : *runs) {
      if (!run.promised || !run.LosesEnergy()) continue;
      broken.push_back(absl::StrCat(run.method, " loses energy: ", run.what));
    }
  }
  for (const std::string& claim : BrokenClaims(results.model_errors)) broken.push_back(claim);
  return broken;
}

// A zero proves something only if the same check has found failures of other methods. No method has
// phantom hits.
std::vector<std::string> BlindLooks(const Results& results) {
  Failures all;
  ForEachMethod(results,
                [&](const CaseResult&, const MethodResult& method) { all.Merge(method.failures); });
  std::vector<std::string> blind;
  for (const FailureKind& kind : kFailureKinds) {
    if (kind.count == &Failures::phantoms || all.*kind.count > 0) continue;
    blind.push_back(absl::StrCat("no method showed any ", kind.name));
  }
  return blind;
}

std::string Text(const Results& results) {
  return absl::StrCat(
      "Made by the program `stability`; what is counted, and how: `tools/stability/README.md`. "
      "e escapes, n negative times, l loops, i still heading inward, m missed piston hits, "
      "p phantom ones, b pistons beyond their walls; - not run.\n\n**The ball alone**\n\n",
      SummaryTable(results.ball), "\n**Ball and piston**\n\n", SummaryTable(results.pair),
      "\n**The gas**\n\n", SummaryTable(results.gas), "\n", UnitSpeedSentence(),
      "\n\n**Energy**\n\n", EnergyTable(results.energy), "\nGases of 4x3 cells:\n\n",
      GasEnergyTable(results.gas_energy),
      "\n**Model errors**: billiard over model - 1, and the error that is stated; ratio: (the "
      "difference - 2 standard errors)/stated, - where the standard error is above half of the "
      "stated error\n\n",
      ModelErrorTable(results.model_errors),
      "\n**Closed forms where they cancel**: relative errors\n\n", CancellationTable(),
      "\n<details><summary>All counts: the ball alone</summary>\n\n",
      CountTable(results.ball, ColumnsOfBall()),
      "\n</details>\n\n<details><summary>All counts: ball and piston</summary>\n\n",
      CountTable(results.pair, ColumnsOfPair()),
      "\n</details>\n\n<details><summary>All counts: the gas</summary>\n\n",
      CountTable(results.gas, ColumnsOfGas()), "\n</details>\n");
}

}  // namespace

Report MakeReport(double effort) {
  const Results results = RunAll(effort);
  Report report = {.text = Text(results), .complaints = BrokenPromises(results)};
  for (const std::string& blind : BlindLooks(results)) report.complaints.push_back(blind);
  return report;
}

}  // namespace ballpiston::stability
