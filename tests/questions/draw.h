// The generator: question `number` of a seed.
//
// Half of the parameters of a question are extreme (values.h). Most targets are such that the
// answer costs less than `most_seconds` of a processor of the day; the others are anything that is
// permitted. One question in seven has one defect, for which the service has to refuse it.
#pragma once

#include <cstdint>

#include "tests/questions/question.h"

namespace ballpiston::questions {

Question Draw(uint64_t seed, uint64_t number, double most_seconds);

}  // namespace ballpiston::questions
