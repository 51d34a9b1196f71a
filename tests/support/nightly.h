// The size of tests: small by default; full with BALLPISTON_NIGHTLY=1 in the environment (`make
// test-long`, part of `make nightly`).
#pragma once

#include <cstdlib>

namespace ballpiston {

inline bool IsNightly() { return std::getenv("BALLPISTON_NIGHTLY") != nullptr; }

}  // namespace ballpiston
