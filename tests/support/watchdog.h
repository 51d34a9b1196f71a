// Shows where a test hangs: every 15 minutes that a test takes, the program prints the test's name
// and the stacks of all threads. The test goes on. No test fails because a machine is slow.
//
// The environment variable BALLPISTON_STACKS_AFTER replaces the 15 minutes by a number of seconds.
#pragma once

namespace ballpiston {

// Watches each test of this program, the set-ups, and the program's end. Call it once, before
// RUN_ALL_TESTS. `program` is argv[0].
void WatchTests(const char* program);

}  // namespace ballpiston
