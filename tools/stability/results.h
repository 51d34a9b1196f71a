// All that the program counts and measures, as tables in Markdown, and the complaints about it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/stability/case.h"
#include "tools/stability/failures.h"
#include "tools/stability/model_errors.h"

namespace ballpiston::stability {

// Neighbouring cases have different names.
struct System {
  const char* title;
  std::vector<CaseResult> results;                   // case by case, the same methods in each case
  std::vector<uint64_t Failures::*> not_looked_for;  // in these cases
};

// A row for each case, a column for each method, failures by letter.
std::string SummaryTable(const System& system);

// A row for each case and method, with all numbers of Failures; - for those that no method of these
// cases looks for.
std::string CountTable(const System& system);

// A row for each case of long runs and each method with a run that reached its end.
//
// In a gas each exchange rounds the energies of two bodies, so the energy makes a random walk. Only
// the mean of many runs shows a drift.
std::string EnergyTable(const std::vector<System>& systems);

struct Results {
  std::vector<System> systems;
  std::vector<ModelError> model_errors;
};

// One sentence for each broken promise, and one for each kind of failure that no method shows. A
// zero proves something only if the same check has found failures of other methods. No method has
// phantom hits.
std::vector<std::string> Complaints(const Results& results);

}  // namespace ballpiston::stability
