// Makes a question simpler while the same check still fails.
#pragma once

#include <functional>

#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::questions {

using Fails = std::function<bool(const v1::EnsembleSpec&)>;

// Drops values of lists, rounds numbers, and simplifies target and method, as long as the command
// gets shorter. Asks `fails` at most `most` times.
v1::EnsembleSpec Shrink(v1::EnsembleSpec spec, const Fails& fails, int most);

}  // namespace ballpiston::questions
