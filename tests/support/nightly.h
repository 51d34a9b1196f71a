// The size of tests: small by default; full with BALLPISTON_NIGHTLY=1 in the environment (`make
// test-long`, part of `make nightly`).
#ifndef BALLPISTON_TESTS_SUPPORT_NIGHTLY_H_
#define BALLPISTON_TESTS_SUPPORT_NIGHTLY_H_

#include <cstdlib>

namespace ballpiston {

inline bool IsNightly() { return std::getenv("BALLPISTON_NIGHTLY") != nullptr; }

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_SUPPORT_NIGHTLY_H_
