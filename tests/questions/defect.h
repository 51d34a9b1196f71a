// A permitted question becomes one that the service has to refuse.
#pragma once

#include "core/ensemble/experiment_kind.h"
#include "tests/questions/dice.h"
#include "tests/questions/question.h"

namespace ballpiston::questions {

// `bound`: of delta.
void AddDefect(Dice& dice, const ExperimentKind& experiment, double bound, Question& question);

}  // namespace ballpiston::questions
