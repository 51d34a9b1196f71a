// Hashes that tell whether two requests, or two questions, are the same. Pure functions.
#pragma once

#include <string>

#include "ballpiston/v1/ensemble.pb.h"

namespace ballpiston::server {

// A hash of everything that determines the answer: the whole specification with its seed, and the
// engine's version. Empty if the job has a budget, because the answer then depends on the machine.
std::string QuestionOf(const v1::EnsembleSpec& spec, const std::string& engine_version);

// A hash of the whole request except its id.
std::string PayloadOf(const v1::CreateEnsembleJobRequest& request);

}  // namespace ballpiston::server
