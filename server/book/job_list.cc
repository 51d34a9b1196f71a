#include "server/book/job_list.h"

#include <algorithm>
#include <utility>

#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

// Upper bound of the encoded size of the job's message: names, times and numbers take less than
// the constant.
size_t MostBytesOf(const JobRecord& record) {
  return 512 + record.principal.size() + record.engine_version.size() + record.spec.size() +
         record.labels.size() + record.error.size();
}

}  // namespace

bool JobFilter::MatchesState(JobState state) const {
  return states.empty() || states.contains(state);
}

bool JobFilter::Matches(const JobRecord& record) const {
  if (!MatchesState(record.state) || record.create_time < since) return false;
  if (!labels.empty() && !std::ranges::includes(LabelsOf(record.labels), labels)) return false;
  if (experiments.empty()) return true;
  const absl::StatusOr<v1::EnsembleSpec> spec = SpecFromBytes(record.spec);
  return spec.ok() && experiments.contains(spec->experiment());
}

PageOfJobs<JobRecord> ReadPage(Database& database, const std::optional<std::string>& principal,
                               const JobsQuery& query) {
  PageOfJobs<JobRecord> page;
  size_t bytes = 0;
  ReadJobs(database, principal, query.before, query.grid, [&](JobRecord record) {
    if (!query.filter.Matches(record)) return true;
    bytes += MostBytesOf(record);
    const bool full = page.jobs.size() == static_cast<size_t>(query.max_jobs);
    const bool ends = full || (!page.jobs.empty() && bytes > query.max_bytes);
    if (ends) page.next_before = page.jobs.back().sequence;
    if (!ends) page.jobs.push_back(std::move(record));
    return !ends;
  });
  return page;
}

}  // namespace ballpiston::server
