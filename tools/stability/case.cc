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

std::string NumberIn(const CountColumn& column, const Failures& failures) {
  const auto* const count = std::get_if<uint64_t Failures::*>(&column.number);
  return count != nullptr ? CountText(failures.**count)
                          : ErrorText(failures.*std::get<double Failures::*>(column.number));
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

CountColumns ColumnsOfBall() {
  return {{"starts", &Failures::orbits},
          {"wall hits", &Failures::hits},
          {"escapes", &Failures::escapes},
          {"negative times", &Failures::negative_times},
          {"loops", &Failures::loops},
          {"still inward", &Failures::inward},
          {"deepest in a disc", &Failures::deepest},
          {"worst dE/E", &Failures::energy}};
}

CountColumns ColumnsOfPair() {
  return {{"starts", &Failures::orbits},
          {"piston hits", &Failures::hits},
          {"escapes", &Failures::escapes},
          {"negative times", &Failures::negative_times},
          {"loops", &Failures::loops},
          {"still inward", &Failures::inward},
          {"looked back", &Failures::looked_back},
          {"missed", &Failures::missed},
          {"phantoms", &Failures::phantoms},
          {"worst dE/E", &Failures::energy}};
}

CountColumns ColumnsOfGas() {
  CountColumns columns = ColumnsOfPair();
  columns.insert(columns.end() - 1, {"pistons beyond", &Failures::beyond_walls});
  return columns;
}

std::string CountTable(const std::vector<CaseResult>& cases, const CountColumns& columns) {
  std::vector<std::string> head = {"case", "method"};
  for (const CountColumn& column : columns) head.push_back(column.head);
  MarkdownTable table(head);
  for (const CaseResult& result : cases) {
    for (const MethodResult& method : result.methods) {
      std::vector<std::string> row = {result.name, method.method};
      for (const CountColumn& column : columns) row.push_back(NumberIn(column, method.failures));
      table.Add(row);
    }
  }
  return table.Text(2);
}

}  // namespace ballpiston::stability
