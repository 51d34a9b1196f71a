// Prints single answers of the server: each as a table, as JSON (one document), as JSON lines, or
// as CSV. In all formats but the table, numbers read back as the same double; the table of the
// closed forms has 12 significant digits.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "ballpiston/v1/analytic.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/server.pb.h"
#include "client/output/point_output.h"

namespace ballpiston::client {

// The closed forms; `outgoing_epsilon` are the request's energies, at which the kernel was
// evaluated.
//
//   table   for each (rho, delta) its quantities, then a row for each epsilon, each beta and each
//           temperature
//   json    {"points": [PairAnalytics, ...]}
//   jsonl   one PairAnalytics per line
//   csv     for each (rho, delta) one row for each epsilon, then one row for each beta and each
//           temperature; a single row if none of these is given. The columns have the proto's
//           names. A cell is empty if its row has no such value. CSV does not contain the kernel.
void PrintAnalytics(const v1::EvaluatePairsResponse& response,
                    const std::vector<double>& outgoing_epsilon, Format format, std::ostream& out);

// Jobs; JSON is {"jobs": [...]}. The table has a column for the principal if the jobs have
// different principals, a column for the priority if a priority is not 0, a column for the results
// if some results are pinned, have expired or will expire within a week (counted from `now`), and a
// column for the labels if some job has one. CSV always has these columns.
void PrintJobs(const std::vector<v1::EnsembleJob>& jobs, absl::Time now, Format format,
               std::ostream& out);

// KEY=VALUE, by key, with blanks between.
std::string LabelsText(const v1::EnsembleJob& job);

// A server's status. The table shows the time since the server's start, counted from `now`. CSV is
// one row, without the fields that are messages.
void PrintStatus(const v1::ServerStatus& status, absl::Time now, Format format, std::ostream& out);

}  // namespace ballpiston::client
