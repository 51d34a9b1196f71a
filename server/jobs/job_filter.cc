#include "server/jobs/job_filter.h"

namespace ballpiston::server {

bool JobFilter::MatchesState(JobState state) const {
  return states.empty() || states.contains(state);
}

bool JobFilter::Matches(const JobRecord& record) const {
  if (!MatchesState(record.state) || record.create_time < since) return false;
  if (experiments.empty()) return true;
  v1::EnsembleSpec spec;
  return spec.ParseFromString(record.spec) && experiments.contains(spec.experiment());
}

}  // namespace ballpiston::server
