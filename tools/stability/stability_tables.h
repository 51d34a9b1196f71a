// The results as Markdown.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/stability/cancellation.h"
#include "tools/stability/energy_drift.h"
#include "tools/stability/failures.h"
#include "tools/stability/gas_energy.h"
#include "tools/stability/model_errors.h"
#include "tools/stability/reversal.h"

namespace ballpiston::stability {

struct MethodResult {
  std::string method;
  bool promised;  // zeros
  Failures failures;
};

struct CaseResult {
  std::string name;
  std::vector<MethodResult> methods;  // the same methods in each case
};

// One row per case, one column per method, failures by letter.
std::string SummaryTable(const std::vector<CaseResult>& cases);
// One row per case and method, one column per kind of failure.
std::string BallTable(const std::vector<CaseResult>& cases);
std::string PairTable(const std::vector<CaseResult>& cases);
std::string GasTable(const std::vector<CaseResult>& cases);

std::string ReversalTable(const std::vector<Reversal>& ball, const std::vector<Reversal>& pair);
std::string EnergyTable(const std::vector<EnergyRun>& runs);
std::string GasEnergyTable(const std::vector<GasEnergyRun>& runs);
std::string ModelErrorTable(const std::vector<ModelError>& errors);
std::string CancellationTable(const std::vector<Cancellation>& rows);

}  // namespace ballpiston::stability
