// Prints the closed forms.
//
//   table   for each (rho, delta) its quantities, then a row for each epsilon and for each beta and
//           temperature
//   json    {"points": [PairAnalytics, ...]};   jsonl: one of them a line
//   csv     for each pair one row for each epsilon, then one for each beta and temperature (one row
//           if there is none of them), columns named as in the proto, cells empty where a row has
//           no such value; the kernel is in the other formats only
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
