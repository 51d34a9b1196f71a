// Prints the closed forms.
//
//   table   for each (rho, delta) its quantities, then a row for each epsilon and each beta
//   json    {"points": [PairAnalytics, ...]};   jsonl: one of them a line
//   csv     one row for each pair and epsilon (one row if there is no epsilon), columns named as in
//           the proto; the kernel and the canonical averages are in the other formats only
//
// All numbers read back as the same double, but in the table: 15 significant digits.
#ifndef BALLPISTON_CLIENT_OUTPUT_ANALYTIC_OUTPUT_H_
#define BALLPISTON_CLIENT_OUTPUT_ANALYTIC_OUTPUT_H_

#include <ostream>
#include <vector>

#include "ballpiston/v1/analytic.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

// `outgoing_epsilon` as in the request: the energies at which the kernel was evaluated.
void PrintAnalytics(const v1::EvaluatePairsResponse& response,
                    const std::vector<double>& outgoing_epsilon, Format format, std::ostream& out);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_ANALYTIC_OUTPUT_H_
