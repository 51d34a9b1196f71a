// Measures the error and the work of every method of computing the pair on this machine. program.h
// describes the output and the exit status.
#include <iostream>

#include "tools/method_comparison/program.h"

int main(int argc, char** argv) {
  return ballpiston::method_comparison::RunProgram(argc, argv, std::cout, std::cerr);
}
