// What the main function of every test program does.
#pragma once

namespace ballpiston {

// Runs all tests under the watchdog (watchdog.h). The test report (--gtest_output) has the
// processor time of each test, with that of the programs that it started, as the property
// "processor_seconds". Returns the exit code.
int RunTests(int argc, char** argv);

}  // namespace ballpiston
