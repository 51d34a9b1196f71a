#include "tools/stability/results.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/statistics/moments.h"
#include "tools/stability/markdown_table.h"

namespace ballpiston::stability {
namespace {

// "0", or the counts of the failures with their letters.
std::string Letters(const Failures& failures) {
  if (failures.orbits == 0) return "-";
  std::string text;
  for (const FailureKind& kind : kFailureKinds) {
    const uint64_t count = failures.*kind.count;
    if (count > 0) absl::StrAppend(&text, text.empty() ? "" : " ", CountText(count), kind.letter);
  }
  return text.empty() ? "0" : text;
}

// Whether the absolute mean exceeds four of its standard errors and an ulp.
bool IsTrend(const Moments& gain) {
  const double size = std::fabs(gain.mean);
  // Written as a negation, so that NaN counts as a trend.
  return !(size <= 4 * gain.StandardError().value_or(0) ||
           size <= std::numeric_limits<double>::epsilon());
}

}  // namespace

std::string SummaryTable(const System& system) {
  Rows rows = {{"case"}};
  for (const CaseResult& result : system.results) {
    if (rows.back().front() != result.name) rows.push_back({result.name});
    if (rows.size() == 2) rows.front().push_back(result.method);
    rows.back().push_back(Letters(result.failures));
  }
  return MarkdownTable(rows, 1);
}

std::string CountTable(const System& system) {
  Rows rows = {{"case", "method", "starts", "hits", "looked back"}};
  for (const FailureKind& kind : kFailureKinds) rows.front().push_back(kind.name);
  rows.front().push_back("worst dE/E");
  for (const CaseResult& result : system.results) {
    const Failures& failures = result.failures;
    const auto text = [&](uint64_t Failures::*count) -> std::string {
      const bool is_blind = std::ranges::count(system.not_looked_for, count) > 0;
      return is_blind ? "-" : CountText(failures.*count);
    };
    rows.push_back({result.name, result.method, CountText(failures.orbits),
                    CountText(failures.hits), text(&Failures::looked_back)});
    for (const FailureKind& kind : kFailureKinds) rows.back().push_back(text(kind.count));
    rows.back().push_back(ErrorText(failures.energy));
  }
  return MarkdownTable(rows, 2);
}

std::string EnergyTable(const std::vector<System>& systems) {
  Rows rows = {{"case", "method", "runs", "hits", "worst dE/E", "mean gain of dE/E",
                "its standard error", "a trend"}};
  for (const System& system : systems) {
    for (const auto& [name, permitted, method, promised, failures] : system.results) {
      const Moments& gain = failures.gain;
      if (permitted == 0 || gain.count == 0) continue;
      rows.push_back({name, method, CountText(gain.count), CountText(failures.hits),
                      ErrorText(failures.energy), SignedText(gain.mean),
                      ErrorText(gain.StandardError().value_or(0)), YesOrNo(IsTrend(gain))});
    }
  }
  return MarkdownTable(rows, 2);
}

std::vector<std::string> Complaints(const Results& results) {
  std::vector<std::string> complaints;
  Failures all;
  for (const System& system : results.systems) {
    for (const auto& [name, permitted, method, promised, failures] : system.results) {
      all.Merge(failures);
      if (!promised) continue;
      if (failures.Total() > 0) complaints.push_back(absl::StrCat(method, " fails: ", name));
      if (permitted == 0) continue;
      if (IsTrend(failures.gain) || !(failures.energy <= permitted)) {
        complaints.push_back(absl::StrCat(method, " loses energy: ", name));
      }
    }
  }
  for (const std::string& claim : BrokenClaims(results.model_errors)) complaints.push_back(claim);
  for (const FailureKind& kind : kFailureKinds) {
    if (kind.count == &Failures::phantoms || all.*kind.count > 0) continue;
    complaints.push_back(absl::StrCat("no method showed this failure: ", kind.name));
  }
  return complaints;
}

}  // namespace ballpiston::stability
