// Runs a computation that may never end, in a separate process.
#ifndef BALLPISTON_TOOLS_STABILITY_OWN_PROCESS_H_
#define BALLPISTON_TOOLS_STABILITY_OWN_PROCESS_H_

#include <functional>
#include <optional>

#include "tools/stability/failures.h"

namespace ballpiston::stability {

// Empty if the computation takes more than `seconds` of processor time. Throws std::runtime_error
// if the process cannot be run, or if it ends without a result for another reason (a crash, or no
// memory). The program must have no other thread.
std::optional<Failures> InOwnProcess(const std::function<Failures()>& compute, unsigned seconds);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_OWN_PROCESS_H_
