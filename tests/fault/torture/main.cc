// Runs the tests or, if the first argument is kHungReaders, the process of the hung readers.
#include <cstring>

#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/hung_readers.h"
#include "tests/support/run_tests.h"

int main(int argc, char** argv) {
  if (argc == 6 && std::strcmp(argv[1], ballpiston::torture::kHungReaders) == 0) {
    return ballpiston::torture::RunHungReaders(argv[2], argv[3], argv[4], argv[5]);
  }
  const int result = ballpiston::RunTests(argc, argv);
  ballpiston::torture::PrintTable();
  return result;
}
