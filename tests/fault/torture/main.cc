// Runs the tests or, if the first argument is kHungReaders, the process of the hung readers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/hung_readers.h"
#include "tests/support/time_limit.h"

int main(int argc, char** argv) {
  if (argc == 6 && std::strcmp(argv[1], ballpiston::torture::kHungReaders) == 0) {
    return ballpiston::torture::RunHungReaders(argv[2], argv[3], argv[4], argv[5]);
  }
  testing::InitGoogleMock(&argc, argv);
  ballpiston::LimitTestTimes(argv[0]);
  const int result = RUN_ALL_TESTS();
  ballpiston::torture::PrintTable();
  return result;
}
