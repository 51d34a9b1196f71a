// The program around the tables: its arguments, where the tables go, its exit status.
//
//   stability [--quick] [--out FILE | --into FILE]
//
// Whether FILE can be written is checked before anything is computed, which takes minutes. If it
// can no longer be written in the end, the tables go to standard output, so that they are not lost.
//
// Exit status: 0; 1 if FILE cannot be written or the report has complaints, with which the tables
// are written nonetheless; 2 for wrong arguments.
#ifndef BALLPISTON_TOOLS_STABILITY_PROGRAM_H_
#define BALLPISTON_TOOLS_STABILITY_PROGRAM_H_

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "tools/stability/report.h"

namespace ballpiston::stability {

// `make_report` computes, given the fraction of the starts. `out` and `error` are the program's
// standard output and standard error.
int RunProgram(const std::vector<std::string>& arguments,
               const std::function<Report(double effort)>& make_report, std::ostream& out,
               std::ostream& error);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_PROGRAM_H_
