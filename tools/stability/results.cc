#include "tools/stability/results.h"

#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/statistics/moments.h"
#include "tools/stability/markdown_table.h"

namespace ballpiston::stability {
namespace {

// Calls `visit` with each case and each of its methods.
template <typename Visit>
void ForEachMethod(const std::vector<System>& systems, const Visit& visit) {
  for (const System& system : systems) {
    for (const CaseResult& result : system.cases) {
      for (const MethodResult& method : result.methods) visit(result, method);
    }
  }
}

// Whether the absolute mean exceeds four of its standard errors and an ulp.
bool IsTrend(const Moments& gain) {
  const double size = std::fabs(gain.mean);
  // Written as a negation, so that NaN counts as a trend.
  return !(size <= 4 * gain.StandardError().value_or(0) ||
           size <= std::numeric_limits<double>::epsilon());
}

bool LosesEnergy(const CaseResult& result, const Failures& failures) {
  return result.permitted > 0 && (IsTrend(failures.gain) || !(failures.energy <= result.permitted));
}

}  // namespace

std::string EnergyTable(const std::vector<System>& systems) {
  MarkdownTable table({"case", "method", "runs", "hits", "worst dE/E", "mean gain of dE/E",
                       "its standard error", "a trend"});
  ForEachMethod(systems, [&](const CaseResult& result, const MethodResult& method) {
    const Moments& gain = method.failures.gain;
    if (result.permitted == 0 || gain.count == 0) return;
    table.Add({result.name, method.method, CountText(gain.count), CountText(method.failures.hits),
               ErrorText(method.failures.energy), SignedText(gain.mean),
               ErrorText(gain.StandardError().value_or(0)), YesOrNo(IsTrend(gain))});
  });
  return table.Text(2);
}

std::vector<std::string> BrokenPromises(const Results& results) {
  std::vector<std::string> broken;
  ForEachMethod(results.systems, [&](const CaseResult& result, const MethodResult& method) {
    if (!method.promised) return;
    const auto complain = [&](const char* complaint) {
      broken.push_back(absl::StrCat(method.method, complaint, result.name));
    };
    if (method.failures.Total() > 0) complain(" fails: ");
    if (LosesEnergy(result, method.failures)) complain(" loses energy: ");
  });
  for (const std::string& claim : BrokenClaims(results.model_errors)) broken.push_back(claim);
  return broken;
}

std::vector<std::string> BlindLooks(const Results& results) {
  Failures all;
  ForEachMethod(results.systems,
                [&](const CaseResult&, const MethodResult& method) { all.Merge(method.failures); });
  std::vector<std::string> blind;
  for (const FailureKind& kind : kFailureKinds) {
    if (kind.count == &Failures::phantoms || all.*kind.count > 0) continue;
    blind.push_back(absl::StrCat("no method showed this failure: ", kind.name));
  }
  return blind;
}

}  // namespace ballpiston::stability
