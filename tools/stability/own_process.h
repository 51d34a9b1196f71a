// Runs a computation that may never end, in a separate process.
#pragma once

#include <functional>
#include <optional>

#include "tools/stability/failures.h"

namespace ballpiston::stability {

// Empty if the computation takes more than `seconds` of processor time. Throws std::runtime_error
// if the process cannot be run, or if it ends without a result for another reason (a crash, or no
// memory). The program must have no other thread.
std::optional<Failures> InOwnProcess(const std::function<Failures()>& compute, unsigned seconds);

}  // namespace ballpiston::stability
