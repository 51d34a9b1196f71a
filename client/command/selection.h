// The jobs that a verb acts on: those that are named, or those that have all labels of --label.
#pragma once

#include <functional>
#include <vector>

#include "client/command/connection.h"

namespace ballpiston::client {

using JobStates = std::vector<v1::EnsembleJob::State>;

inline const JobStates kActiveStates = {v1::EnsembleJob::QUEUED, v1::EnsembleJob::RUNNING,
                                        v1::EnsembleJob::CANCELLING};
inline const JobStates kEndedStates = {v1::EnsembleJob::SUCCEEDED, v1::EnsembleJob::FAILED,
                                       v1::EnsembleJob::CANCELLED};

using VerbOfJobs =
    std::function<VerbResult(const Connection&, const std::vector<v1::EnsembleJob>&)>;

// Connects and calls `verb` with the named jobs (only `name` is set); with --label with those in
// one of the states (empty: any), newest first. INVALID_ARGUMENT if there are neither names nor
// labels, or both. NOT_FOUND if no job has the labels.
VerbResult WithJobs(const Options& options, const Terminal& terminal, const JobStates& states,
                    const VerbOfJobs& verb);

}  // namespace ballpiston::client
