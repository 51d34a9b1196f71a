// The arguments, the output and the exit status of the program `stability`.
//
//   stability [--quick] [--out FILE | --into FILE]
//
// The computation takes minutes. Therefore the program first checks that FILE can be written. If
// FILE cannot be written at the end, the tables go to standard output, so that they are not lost.
//
// Exit status: 0 success; 1 if FILE cannot be written, or if the report has complaints (then the
// tables are still written), or if the report cannot be made (no tables); 2 for wrong arguments.
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
