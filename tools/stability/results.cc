#include "tools/stability/results.h"

#include "absl/strings/str_cat.h"

namespace ballpiston::stability {
namespace {

// Calls `visit` with each case and each of its methods.
template <typename Visit>
void ForEachMethod(const Results& results, const Visit& visit) {
  for (const System& system : results.systems) {
    for (const CaseResult& result : system.cases) {
      for (const MethodResult& method : result.methods) visit(result, method);
    }
  }
}

}  // namespace

std::vector<std::string> BrokenPromises(const Results& results) {
  std::vector<std::string> broken;
  ForEachMethod(results, [&](const CaseResult& result, const MethodResult& method) {
    if (!method.promised || method.failures.Total() == 0) return;
    broken.push_back(absl::StrCat(method.method, " fails: ", result.name));
  });
  for (const EnergyRun& run : results.energy) {
    if (!run.promised || !run.LosesEnergy()) continue;
    broken.push_back(absl::StrCat(run.method, " loses energy: ", run.what));
  }
  for (const std::string& claim : BrokenClaims(results.model_errors)) broken.push_back(claim);
  return broken;
}

std::vector<std::string> BlindLooks(const Results& results) {
  Failures all;
  ForEachMethod(results,
                [&](const CaseResult&, const MethodResult& method) { all.Merge(method.failures); });
  std::vector<std::string> blind;
  for (const FailureKind& kind : kFailureKinds) {
    if (kind.count == &Failures::phantoms || all.*kind.count > 0) continue;
    blind.push_back(absl::StrCat("no method showed this failure: ", kind.name));
  }
  return blind;
}

}  // namespace ballpiston::stability
