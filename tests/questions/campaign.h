// Asks many questions, and prints what became of them.
#pragma once

#include "tests/questions/checks.h"
#include "tests/questions/question.h"

namespace ballpiston::questions {

struct Size {
  uint64_t seed = 1;
  uint64_t first = 0;
  uint64_t questions = 300;
  // Questions that are planned above this processor time are started and stopped.
  double most_seconds = 0.01;
};

// The size of `make test`, or the one that the environment chooses (README.md).
Size SizeFromEnvironment();

using Asker = std::function<Report(const Question&)>;

// Prints the counts by experiment and outcome. Prints each kind of failure when it is found: the
// broken check, and the command that shows it. Returns the number of questions that break a check.
int AskAll(const std::string& name, const Size& size, const Asker& ask);

}  // namespace ballpiston::questions
