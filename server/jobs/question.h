// What makes two requests the same. Pure functions.
#ifndef BALLPISTON_SERVER_JOBS_QUESTION_H_
#define BALLPISTON_SERVER_JOBS_QUESTION_H_

#include <string>

#include "ballpiston/v1/ensemble.pb.h"

namespace ballpiston::server {

// A hash of all that the answer depends on: the whole specification, its seed included, and the
// engine's version. Empty if the answer depends on the machine as well: with a budget.
std::string QuestionOf(const v1::EnsembleSpec& spec, const std::string& engine_version);

// A hash of all of a request but its id.
std::string PayloadOf(const v1::CreateEnsembleJobRequest& request);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_QUESTION_H_
