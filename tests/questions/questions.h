// Random questions to the service. The engine answers them in this process or in a child process,
// which may crash or never end. A real server answers them, too. Each of the three returns the
// outcome (answered, refused, stopped, ...), and throws Violation if a rule is broken (checks.h).
#pragma once

#include "core/ensemble/point_experiment.h"
#include "tests/questions/checks.h"

namespace ballpiston::questions {

// `ballpiston run --spec - ...`, for a shell: it asks exactly this specification.
std::string Command(const v1::EnsembleSpec& question);

// Question `number` of a seed, in the permitted domain. A third of its parameters are extreme
// (draw.cc). With most targets the answer costs less than `most_seconds` of a present-day
// processor; the other targets are any that are permitted. The service may still refuse the
// question, for instance because no machine could answer it.
v1::EnsembleSpec Draw(uint64_t seed, uint64_t number, double most_seconds);

// Checks the question, plans it, and computes its answer, or stops the computation at once if the
// planned cost is above `most_seconds` of a processor of the day. Then compares the models.
std::string AskEngine(const v1::EnsembleSpec& question, double most_seconds);

// The outcome of `ask`, which runs in a forked process and must not start threads. If the process
// dies or reports nothing, the broken rule is "crash". If it takes more than kMostProcessorSeconds,
// the broken rule is kEndCheck.
std::string InChild(const std::function<std::string()>& ask);

// Returns a function that asks ballpistond, a process on a Unix socket in a temporary folder. The
// function plans a question, and runs it to its end, or starts and cancels it if the planned
// processor time is above `most_seconds`. If the server dies or never ends, the function starts a
// new one for the next question.
std::function<std::string(const v1::EnsembleSpec&)> ServerAsker(double most_seconds);

// The result at one point, as the server computes it. The spec has no violations and no budget.
v1::PointResult ComputePoint(const EnsembleSpec& spec, size_t index, const Answer& answer);

// The number of samples that `model` is planned to compute in `seconds` at the point `index`. For a
// model without samples: a number above any other.
double SamplesIn(double seconds, const EnsembleSpec& spec, size_t index, Model model,
                 const Machine& machine);

// The same question with a number of samples in the place of its target.
EnsembleSpec WithSamples(EnsembleSpec spec, double samples);

}  // namespace ballpiston::questions
