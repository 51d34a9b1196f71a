// The flags, the output and the exit status of the program `method_comparison`.
//
// Prints CSV: a header, then one row for each measurement, as soon as it is made:
//
//   rho,delta,epsilon,method,time_step,quantity,samples,wall_hits,work_seconds,value,...
//   0.53,0.1,0.125,billiard,0,mean-free-time,4096,301923,0.0031,0.012,...
//
// The last columns are statistical_error, own_error and bias_resolved (1 or 0). rho and epsilon are
// the values of the spec; method_comparison.h explains the other columns, method.h the names. A
// number reads back as the same double. The field of an unknown value is empty.
//
// Progress is one line on standard error, which is redrawn and cleared at the end.
//
// Exit status: 0 success; 1 standard output cannot be written, or the mean free time, the ingoing
// law or the trajectory has no measurement of kFewestDrawn samples: then its panel of the chart is
// empty, but all rows are printed; 2 a wrong flag or value: standard error names each value that is
// not permitted.
#pragma once

#include <cstdint>
#include <ostream>

namespace ballpiston::method_comparison {

// Errors from fewer samples are too uncertain; the chart does not draw them.
inline constexpr uint64_t kFewestDrawn = 64;

// `out` and `error` are the program's standard output and standard error.
int RunProgram(int argc, const char* const* argv, std::ostream& out, std::ostream& error);

}  // namespace ballpiston::method_comparison
