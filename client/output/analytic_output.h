// Prints the closed forms.
//
//   table   for each (rho, delta) its quantities, then a row for each epsilon, each beta and each
//           temperature
//   json    {"points": [PairAnalytics, ...]}
//   jsonl   one PairAnalytics per line
//   csv     for each (rho, delta) one row for each epsilon, then one row for each beta and each
//           temperature; a single row if none of these is given. The columns have the proto's
//           names. A cell is empty if its row has no such value. CSV does not contain the kernel.
//
// The table has 15 significant digits. In the other formats all numbers read back as the same
// double.
#pragma once

#include <ostream>
#include <vector>

#include "ballpiston/v1/analytic.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

// `outgoing_epsilon`: the request's energies, at which the kernel was evaluated.
void PrintAnalytics(const v1::EvaluatePairsResponse& response,
                    const std::vector<double>& outgoing_epsilon, Format format, std::ostream& out);

}  // namespace ballpiston::client
