// The core's experiments, as the worker pool takes them.
#ifndef BALLPISTON_SERVER_EXECUTION_CORE_EXPERIMENTS_H_
#define BALLPISTON_SERVER_EXECUTION_CORE_EXPERIMENTS_H_

#include "server/execution/run.h"

namespace ballpiston::server {

inline ExperimentFactory CoreExperiments() { return &PointExperiment::Create; }

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_CORE_EXPERIMENTS_H_
