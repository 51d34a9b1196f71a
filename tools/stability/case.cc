#include "tools/stability/case.h"

#include "absl/strings/str_cat.h"
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

std::string CountTable(const std::vector<CaseResult>& cases,
                       std::span<uint64_t Failures::*const> not_looked_for) {
  const auto text = [&](const Failures& failures, uint64_t Failures::*count) -> std::string {
    if (std::ranges::find(not_looked_for, count) != not_looked_for.end()) return "-";
    return CountText(failures.*count);
  };
  std::vector<std::string> head = {"case", "method", "starts", "hits", "looked back"};
  for (const FailureKind& kind : kFailureKinds) head.push_back(kind.name);
  head.push_back("worst dE/E");
  MarkdownTable table(head);
  for (const CaseResult& result : cases) {
    for (const auto& [method, promised, failures] : result.methods) {
      std::vector<std::string> row = {result.name, method, CountText(failures.orbits),
                                      CountText(failures.hits),
                                      text(failures, &Failures::looked_back)};
      for (const FailureKind& kind : kFailureKinds) row.push_back(text(failures, kind.count));
      row.push_back(ErrorText(failures.energy));
      table.Add(row);
    }
  }
  return table.Text(2);
}

}  // namespace ballpiston::stability
