#include "server/jobs/job_state.h"

namespace ballpiston::server {

bool HasEnded(JobState state) {
  return state == v1::EnsembleJob::SUCCEEDED || state == v1::EnsembleJob::FAILED ||
         state == v1::EnsembleJob::CANCELLED;
}

std::string StateName(JobState state) { return v1::EnsembleJob::State_Name(state); }

}  // namespace ballpiston::server
