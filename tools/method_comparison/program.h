// The flags, the output and the exit status of the program `method_comparison`.
//
// Prints one JSON object a line for each measurement, as soon as it is made:
//
//   {"method":"billiard","time_step":0,"quantity":"mean-free-time","delta":0.1,"samples":4096,
//    "wall_hits":301923,"work_seconds":0.0031,"value":0.012,"statistical_error":0.017}
//
// method_comparison.h says what they are, method.h the names.
//
// Exit status: 0 success; 1 standard output cannot be written; 2 a wrong flag or value: standard
// error names each value that is not permitted.
#ifndef BALLPISTON_TOOLS_METHOD_COMPARISON_PROGRAM_H_
#define BALLPISTON_TOOLS_METHOD_COMPARISON_PROGRAM_H_

#include <ostream>

namespace ballpiston::method_comparison {

// `out` and `error` are the program's standard output and standard error.
int RunProgram(int argc, const char* const* argv, std::ostream& out, std::ostream& error);

}  // namespace ballpiston::method_comparison

#endif  // BALLPISTON_TOOLS_METHOD_COMPARISON_PROGRAM_H_
