// The pages of a list of jobs: which jobs match a filter, and where a page ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "ballpiston/v1/spec.pb.h"
#include "server/store/job_record.h"
#include "server/store/job_table.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

// Limits of what one page reads from the store to find matching jobs. 2,000 small jobs take 4 ms;
// 16 MiB of large jobs take 12 ms.
inline constexpr int kMaxJobsRead = 2000;
inline constexpr size_t kMaxJobBytesRead = size_t{16} << 20;

// A list contains the jobs that match all parts of its filter.
struct JobFilter {
  std::set<JobState> states = {};                           // empty: any
  std::set<v1::EnsembleSpec::Experiment> experiments = {};  // empty: any
  absl::Time since = absl::InfinitePast();                  // the job was created then or later
  Labels labels = {};                                       // the job has all of these

  bool MatchesState(JobState state) const;
  // Whether the job matches all parts. A specification that cannot be read has no experiment.
  bool Matches(const JobRecord& record) const;
};

struct JobsQuery {
  JobFilter filter = {};
  Grid grid = Grid::kIncluded;
  int64_t before = 0;  // jobs older than this sequence, newest first
  int max_jobs = 1;
  size_t max_bytes = 0;  // ends a page that has at least one job
  // These also end a page that has no job yet. A page reads at least one job.
  int max_jobs_read = kMaxJobsRead;
  size_t max_bytes_read = kMaxJobBytesRead;
};

template <typename Job>
struct PageOfJobs {
  std::vector<Job> jobs = {};
  std::optional<int64_t> next_before = {};  // where the next page begins; empty: this is the last
};

// The jobs of one principal, or of all. Runs inside the transaction of its caller.
PageOfJobs<JobRecord> ReadPage(Database& database, const std::optional<std::string>& principal,
                               const JobsQuery& query);

}  // namespace ballpiston::server
