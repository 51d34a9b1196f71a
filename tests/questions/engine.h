// Asks the engine in this process, or in a process of its own, which may crash or never end; or
// asks a real server.
#pragma once

#include "core/ensemble/point_experiment.h"
#include "tests/questions/checks.h"
#include "tests/questions/question.h"

namespace ballpiston::questions {

// Checks the question, plans it, and computes its answer, or stops the computation at once if the
// planned cost is above `most_seconds` of a processor of the day. Then compares the models.
Report AskEngine(const Question& question, double most_seconds);

// The report of `ask`, which runs in a forked process and must not start threads. If the process
// dies or gives no report, the finding is "crash"; if it takes more than kMostProcessorSeconds,
// kEndCheck.
Report InChild(const std::function<Report()>& ask);

// Returns a function that asks ballpistond, a process on a Unix socket in a temporary folder. The
// function plans a question, and runs it to its end, or starts and cancels it if the planned
// processor time is above `most_seconds`. If the server dies or never ends, the function starts a
// new one for the next question.
std::function<Report(const Question&)> ServerAsker(double most_seconds);

// ---- one point, as the server computes it ----

struct ComputedPoint {
  v1::PointResult result;
  Findings findings;  // numbers that are not finite, which the message leaves out
};

// The spec has no violations and no budget.
ComputedPoint ComputePoint(const EnsembleSpec& spec, size_t index, const Answer& answer);

// Starts the computation and stops it where the engine first asks whether to stop.
void StartAndStop(const EnsembleSpec& spec, size_t index, const Answer& answer);

// The number of samples that `model` is planned to compute in `seconds` at the point `index`. For a
// model without samples: a number above any other.
double SamplesIn(double seconds, const EnsembleSpec& spec, size_t index, Model model,
                 const Machine& machine);

// The same question with a number of samples, or of collisions, in the place of its target.
EnsembleSpec WithSamples(EnsembleSpec spec, double samples);

}  // namespace ballpiston::questions
