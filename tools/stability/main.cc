// Computes the stability tables: the failures of every engine in every precision, and of the naive
// methods, in each situation. program.h describes the arguments and the exit status.
#include <iostream>
#include <string>
#include <vector>

#include "tools/stability/program.h"
#include "tools/stability/report.h"

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  return ballpiston::stability::RunProgram(arguments, ballpiston::stability::MakeReport, std::cout,
                                           std::cerr);
}
