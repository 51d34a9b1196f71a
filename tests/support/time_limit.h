// A test that hangs fails, and says where: at its time limit the program prints the test's name and
// the stacks of all threads, and exits with code 1.
//
// A test has 60 s. The few that need longer have a row in time_limit.cc. The environment variable
// BALLPISTON_TEST_TIME_SCALE multiplies all limits: for slow sanitizers, emulators and debuggers.
#ifndef BALLPISTON_TESTS_SUPPORT_TIME_LIMIT_H_
#define BALLPISTON_TESTS_SUPPORT_TIME_LIMIT_H_

#include <chrono>
#include <string_view>

namespace ballpiston {

// By its full name, SUITE.NAME; before the scale.
std::chrono::seconds TimeLimitOf(std::string_view test);

// Limits the time of each test of this program, and of the program's end. Once, before
// RUN_ALL_TESTS; `program` is argv[0].
void LimitTestTimes(const char* program);

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_SUPPORT_TIME_LIMIT_H_
