// The failures of all methods in all cases of a system, as tables in Markdown.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "tools/stability/case.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

// A row for each case, a column for each method, failures by letter.
std::string SummaryTable(const std::vector<CaseResult>& cases);

struct CountColumn {
  std::string head;
  std::variant<uint64_t Failures::*, double Failures::*> number;
};
using CountColumns = std::vector<CountColumn>;

CountColumns ColumnsOfBall();
CountColumns ColumnsOfPair();
CountColumns ColumnsOfGas();

// A row for each case and method.
std::string CountTable(const std::vector<CaseResult>& cases, const CountColumns& columns);

}  // namespace ballpiston::stability
