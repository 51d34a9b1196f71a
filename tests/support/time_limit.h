// Time limits for tests. When a test reaches its limit, the program prints the test's name and the
// stacks of all threads, and exits with code 1.
//
// The usual limit is 60 s. A test that needs longer has a row in time_limit.cc. The environment
// variable BALLPISTON_TEST_TIME_SCALE multiplies all limits, for slow sanitizers, emulators and
// debuggers.
#ifndef BALLPISTON_TESTS_SUPPORT_TIME_LIMIT_H_
#define BALLPISTON_TESTS_SUPPORT_TIME_LIMIT_H_

#include <chrono>
#include <string_view>

namespace ballpiston {

// The limit of the test with the full name SUITE.NAME, without the factor of the environment
// variable.
std::chrono::seconds TimeLimitOf(std::string_view test);

// Limits the time of each test of this program, of set-ups, and of the program's end. Call it once,
// before RUN_ALL_TESTS. `program` is argv[0].
void LimitTestTimes(const char* program);

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_SUPPORT_TIME_LIMIT_H_
