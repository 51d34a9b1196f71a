// The arguments, the output and the exit status of the program `stability`.
//
//   stability [--quick]
//
// Exit status: 0 success; 1 if the report has complaints (after the tables), if it cannot be made
// (no tables), or if standard output cannot be written; 2 for wrong arguments.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "tools/stability/report.h"

namespace ballpiston::stability {

// `make_report` computes the tables; `effort` is the fraction of the starts. It may throw. `out`
// and `error` are the program's standard output and standard error.
int RunProgram(const std::vector<std::string>& arguments,
               const std::function<Report(double effort)>& make_report, std::ostream& out,
               std::ostream& error);

}  // namespace ballpiston::stability
