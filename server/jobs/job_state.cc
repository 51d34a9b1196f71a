#include "server/jobs/job_state.h"

namespace ballpiston::server {

bool HasEnded(JobState state) {
  return state == v1::EnsembleJob::SUCCEEDED || state == v1::EnsembleJob::FAILED ||
         state == v1::EnsembleJob::CANCELLED;
}

bool MayFollow(JobState from, JobState to) {
  switch (to) {
    case v1::EnsembleJob::RUNNING:
      return from == v1::EnsembleJob::QUEUED;
    case v1::EnsembleJob::CANCELLING:
    case v1::EnsembleJob::SUCCEEDED:
    case v1::EnsembleJob::FAILED:
      return from == v1::EnsembleJob::QUEUED || from == v1::EnsembleJob::RUNNING;
    case v1::EnsembleJob::CANCELLED:
      return from == v1::EnsembleJob::CANCELLING;
    default:
      return false;
  }
}

std::string StateName(JobState state) { return v1::EnsembleJob::State_Name(state); }

}  // namespace ballpiston::server
