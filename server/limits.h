// Limits of a job, of a principal and of all principals together. The flag of a limit is its name
// with dashes (--max-streams). 0 means no limit; max_streams is always limited.
#pragma once

#include <algorithm>
#include <cstdint>

namespace ballpiston::server {

// Each stream has a thread.
inline constexpr int64_t kMostStreams = 32'768;

struct Limits {
  int64_t max_active_jobs_per_principal = 1'000;        // jobs that have not ended
  int64_t max_active_points_per_principal = 5'000'000;  // sum over the grids of these jobs
  int64_t max_points_per_job = 100'000;
  int64_t max_streams = 2'048;  // open watches and traces; 0: kMostStreams
  int64_t max_streams_per_principal = 1'024;
  // MiB, upper bound, of all points that the server computes at a time. The program's default is a
  // share of the machine's memory.
  int64_t max_memory_mib = 0;
  // Stored results.
  double retain_days = 0;       // from the end of a job until its results expire
  int64_t max_store_bytes = 0;  // above 95 % of it results expire (book/retention.cc)
};

inline int64_t MostStreams(const Limits& limits) {
  return limits.max_streams == 0 ? kMostStreams : std::min(limits.max_streams, kMostStreams);
}

}  // namespace ballpiston::server
