// A question to the service, and the command line that asks it.
#pragma once

#include <string>

#include "ballpiston/v1/spec.pb.h"

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

}  // namespace ballpiston::questions
