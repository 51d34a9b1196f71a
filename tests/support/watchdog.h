// Names the test that hangs: every 15 minutes that a test takes, the program prints the test's
// name. The test goes on. No test fails because a machine is slow.
//
// The environment variable BALLPISTON_HANGS_AFTER replaces the 15 minutes by a number of seconds.
#pragma once

namespace ballpiston {

// Watches each test of this program, the set-ups, and the program's end. Call it once, before
// RUN_ALL_TESTS.
void WatchTests();

}  // namespace ballpiston
