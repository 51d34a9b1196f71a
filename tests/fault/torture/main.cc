// The tests, or, where the first argument says so, one of the processes that they torment servers
// with.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/hung_readers.h"
#include "tests/fault/torture/server_process.h"

int main(int argc, char** argv) {
  if (argc == 5 && std::strcmp(argv[1], ballpiston::torture::kHungReaders) == 0) {
    return ballpiston::torture::RunHungReaders(argv[2], argv[3], argv[4]);
  }
  if (argc > 2 && std::strcmp(argv[1], ballpiston::torture::kMortal) == 0) {
    return ballpiston::torture::RunMortal(argv + 2);
  }
  testing::InitGoogleTest(&argc, argv);
  const int result = RUN_ALL_TESTS();
  ballpiston::torture::PrintTable();
  return result;
}
