// The main function of all test programs.
#include "gmock/gmock.h"
#include "tests/support/time_limit.h"

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  ballpiston::LimitTestTimes(argv[0]);
  return RUN_ALL_TESTS();
}
