// The main function of all test programs.
#include "tests/support/run_tests.h"

int main(int argc, char** argv) { return ballpiston::RunTests(argc, argv); }
