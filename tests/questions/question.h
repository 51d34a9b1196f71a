// A question to the service, the command line that asks it, and the generator (draw.cc).
#pragma once

#include "ballpiston/v1/spec.pb.h"
#include "tests/support/preamble.h"

namespace ballpiston::questions {

struct Question {
  v1::EnsembleSpec spec;
  // Why the service has to refuse the question; empty if it lies in the permitted domain. The
  // service may still refuse such a question, for instance because no machine could answer it.
  std::string defect = {};
};

// The double next to the budget.
double BudgetSeconds(const v1::Target& target);

// `ballpiston run --spec - ...`, for a shell: it asks exactly this specification.
std::string Command(const v1::EnsembleSpec& spec);

// Question `number` of a seed. A third of its parameters are extreme (draw.cc). With most targets
// the answer costs less than `most_seconds` of a present-day processor; the other targets are any
// that are permitted. One question in seven has one defect, for which the service has to refuse it.
Question Draw(uint64_t seed, uint64_t number, double most_seconds);

}  // namespace ballpiston::questions
