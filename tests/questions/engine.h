// Asks the engine in this process.
#pragma once

#include "tests/questions/question.h"
#include "tests/questions/report.h"

namespace ballpiston::questions {

// Checks the question, plans it, and computes its answer, or stops the computation at once if the
// planned cost is above `most_seconds` of a processor of the day. Then compares the models.
Report AskEngine(const Question& question, double most_seconds);

}  // namespace ballpiston::questions
