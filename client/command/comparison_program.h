// Runs the program `method_comparison`, which has to lie in the folder of this program.
#ifndef BALLPISTON_CLIENT_COMMAND_COMPARISON_PROGRAM_H_
#define BALLPISTON_CLIENT_COMMAND_COMPARISON_PROGRAM_H_

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/interrupts.h"

namespace ballpiston::client {

inline constexpr char kComparisonProgram[] = "method_comparison";

// Calls `take` with each line that the program prints, as it comes, and returns its exit status.
// SIGINT ends the program: 128 + SIGINT. Its errors go to standard error. FAILED_PRECONDITION if it
// is missing: the message names the path.
absl::StatusOr<int> RunComparisonProgram(std::vector<std::string> flags, Interrupts& interrupts,
                                         const std::function<void(const std::string&)>& take);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_COMPARISON_PROGRAM_H_
