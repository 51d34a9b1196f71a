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
  size_t bytes = 0;       // of its jobs
  int read = 0;           // jobs read, matching or not
  size_t bytes_read = 0;  // of these
  int64_t last_read = 0;
  const auto take = [&](JobRecord record) {
    const size_t size = MostBytesOf(record);
    const bool matches = query.filter.Matches(record);
    const bool has_read_enough =
        read == query.max_jobs_read || bytes_read + size > query.max_bytes_read;
    const bool has_room = !matches || page.jobs.empty() || bytes + size <= query.max_bytes;
    const bool is_full = page.jobs.size() == static_cast<size_t>(query.max_jobs);
    if ((read > 0 && has_read_enough) || is_full || !has_room) {
      page.next_before = last_read;
      return false;
    }
    ++read;
    bytes_read += size;
    last_read = record.sequence;
    if (!matches) return true;
    bytes += size;
    page.jobs.push_back(std::move(record));
    return true;
  };
  ReadJobs(database, principal, query.before, query.grid, take);
  return page;
}

}  // namespace ballpiston::server
