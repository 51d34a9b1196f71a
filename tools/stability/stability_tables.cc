#include "tools/stability/stability_tables.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tools/stability/markdown_table.h"

namespace ballpiston::stability {
namespace {

// "0", or the counts of the failures with their letters.
std::string Letters(const Failures& f) {
  if (f.orbits == 0) return "-";
  const std::pair<uint64_t, const char*> kinds[] = {
      {f.escapes, "e"}, {f.negative_times, "n"}, {f.loops, "l"},       {f.inward, "i"},
      {f.missed, "m"},  {f.phantoms, "p"},       {f.beyond_walls, "b"}};
  std::string text;
  for (const auto& [count, letter] : kinds) {
    if (count > 0) absl::StrAppend(&text, text.empty() ? "" : " ", CountText(count), letter);
  }
  return text.empty() ? "0" : text;
}

// The case's name in its first row; empty in the others.
std::string Group(const CaseResult& result, size_t row) { return row == 0 ? result.name : ""; }

std::vector<std::string> HeadOfContacts() {
  return {"case",  "method",       "starts",      "piston hits", "escapes",  "negative times",
          "loops", "still inward", "looked back", "missed",      "phantoms", "worst dE/E"};
}

std::vector<std::string> RowOfContacts(const CaseResult& result, size_t row) {
  const auto& [method, promised, f] = result.methods[row];
  return {Group(result, row),       method,
          CountText(f.orbits),      CountText(f.hits),
          CountText(f.escapes),     CountText(f.negative_times),
          CountText(f.loops),       CountText(f.inward),
          CountText(f.looked_back), CountText(f.missed),
          CountText(f.phantoms),    ErrorText(f.energy)};
}

}  // namespace

std::string SummaryTable(const std::vector<CaseResult>& cases) {
  std::vector<std::string> head = {"case"};
  for (const MethodResult& method : cases.front().methods) head.push_back(method.method);
  MarkdownTable table(head);
  for (const CaseResult& result : cases) {
    std::vector<std::string> row = {result.name};
    for (const MethodResult& method : result.methods) row.push_back(Letters(method.failures));
    table.Add(row);
  }
  return table.Text(1);
}

std::string BallTable(const std::vector<CaseResult>& cases) {
  MarkdownTable table({"case", "method", "starts", "wall hits", "escapes", "negative times",
                       "loops", "still inward", "deepest in a disc", "worst dE/E"});
  for (const CaseResult& result : cases) {
    for (size_t i = 0; i < result.methods.size(); ++i) {
      const auto& [method, promised, f] = result.methods[i];
      table.Add({Group(result, i), method, CountText(f.orbits), CountText(f.hits),
                 CountText(f.escapes), CountText(f.negative_times), CountText(f.loops),
                 CountText(f.inward), ErrorText(f.deepest), ErrorText(f.energy)});
    }
  }
  return table.Text(2);
}

std::string PairTable(const std::vector<CaseResult>& cases) {
  MarkdownTable table(HeadOfContacts());
  for (const CaseResult& result : cases) {
    for (size_t i = 0; i < result.methods.size(); ++i) {
      if (result.methods[i].failures.orbits == 0) continue;
      table.Add(RowOfContacts(result, i));
    }
  }
  return table.Text(2);
}

std::string GasTable(const std::vector<CaseResult>& cases) {
  std::vector<std::string> head = HeadOfContacts();
  head.insert(head.end() - 1, "pistons beyond");
  MarkdownTable table(head);
  for (const CaseResult& result : cases) {
    for (size_t i = 0; i < result.methods.size(); ++i) {
      std::vector<std::string> row = RowOfContacts(result, i);
      row.insert(row.end() - 1, CountText(result.methods[i].failures.beyond_walls));
      table.Add(row);
    }
  }
  return table.Text(2);
}

std::string ReversalTable(const std::vector<Reversal>& ball, const std::vector<Reversal>& pair) {
  std::vector<std::string> head = {"what", "method"};
  for (const uint64_t hits : kReversalHits) head.push_back(absl::StrCat(hits, " hits"));
  MarkdownTable table(head);
  const auto add = [&table](const std::string& what, const std::vector<Reversal>& reversals) {
    for (const Reversal& reversal : reversals) {
      std::vector<std::string> row = {&reversal == &reversals.front() ? what : "", reversal.method};
      for (const double distance : reversal.median) row.push_back(ErrorText(distance));
      table.Add(row);
    }
  };
  add("ball alone", ball);
  add("from collision to collision with the piston", pair);
  return table.Text(2);
}

std::string EnergyTable(const std::vector<EnergyRun>& runs) {
  MarkdownTable table({"method", "what", "orbits", "wall hits", "worst dE/E", "drift over the run",
                       "its standard error", "a trend"});
  for (const EnergyRun& run : runs) {
    table.Add({run.method, run.what, CountText(run.orbits), CountText(run.hits),
               ErrorText(run.record.Worst()), SignedText(run.record.Drift()),
               ErrorText(run.record.DriftError()), Drifts(run) ? "yes" : "no"});
  }
  return table.Text(2);
}

std::string GasEnergyTable(const std::vector<GasEnergyRun>& runs) {
  MarkdownTable table({"method", "gases", "piston hits", "worst dE/E", "mean at the end",
                       "its standard error", "a trend"});
  for (const GasEnergyRun& run : runs) {
    table.Add({run.method, CountText(run.errors.count), CountText(run.exchanges),
               ErrorText(run.worst), SignedText(run.errors.mean),
               ErrorText(run.errors.StandardError().value_or(0)), HasTrend(run) ? "yes" : "no"});
  }
  return table.Text(1);
}

std::string ModelErrorTable(const std::vector<ModelError>& errors) {
  MarkdownTable table(
      {"claim", "place", "difference", "its standard error", "stated", "ratio", "at most 4 times"});
  std::string claim;
  for (const ModelError& error : errors) {
    const std::string before = std::exchange(claim, ClaimOf(error.question));
    table.Add({claim == before ? "" : claim, PlaceOf(error.question), SignedText(error.difference),
               ErrorText(error.standard_error), ErrorText(error.Stated()),
               error.Counts() ? absl::StrFormat("%.2f", error.Ratio()) : "-",
               error.IsTight() ? "yes" : "no"});
  }
  return table.Text(2);
}

std::string CancellationTable(const std::vector<Cancellation>& rows) {
  MarkdownTable table({"quantity", "where", "as printed", "core/closed_form"});
  for (const Cancellation& row : rows) {
    table.Add({row.quantity, row.where, ErrorText(row.printed), ErrorText(row.library)});
  }
  return table.Text(2);
}

}  // namespace ballpiston::stability
