#include "server/jobs/job_filter.h"

#include "server/convert/spec.h"

namespace ballpiston::server {

bool JobFilter::MatchesState(JobState state) const {
  return states.empty() || states.contains(state);
}

bool JobFilter::Matches(const JobRecord& record) const {
  if (!MatchesState(record.state) || record.create_time < since) return false;
  if (experiments.empty()) return true;
  const absl::StatusOr<v1::EnsembleSpec> spec = SpecFromBytes(record.spec);
  return spec.ok() && experiments.contains(spec->experiment());
}

}  // namespace ballpiston::server
