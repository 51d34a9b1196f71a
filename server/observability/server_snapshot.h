// The server's counts at one moment.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "server/observability/slurm_status.h"

namespace ballpiston::server {

struct PrincipalSnapshot {
  std::string principal;
  int64_t queued_jobs = 0;
  int64_t running_jobs = 0;  // and those that are being cancelled
  int64_t stored_jobs = 0;
  int64_t stored_bytes = 0;
};

struct ServerSnapshot {
  std::string version;
  std::string engine_version;
  absl::Time start_time;
  bool draining = false;

  // Active jobs, by state.
  int64_t queued_jobs = 0;
  int64_t running_jobs = 0;
  int64_t cancelling_jobs = 0;
  // Jobs that ended since the start.
  uint64_t jobs_succeeded = 0;
  uint64_t jobs_failed = 0;
  uint64_t jobs_cancelled = 0;

  int64_t engine_crashes = 0;  // of all processes with this data folder

  std::optional<absl::Time> certificate_expiry;  // none without TLS

  int workers = 0;
  int busy_workers = 0;
  // Since the start.
  double blocks_computed = 0;
  double samples_computed = 0;
  double processor_seconds = 0;  // of all executors

  std::optional<SlurmStatus> slurm;  // none without a cluster

  int64_t streams = 0;
  int64_t expiring_jobs = 0;                  // whose results expire soon
  std::vector<PrincipalSnapshot> principals;  // those with jobs

  int64_t store_bytes = 0;  // on disk, the log included
  int64_t store_commits = 0;
  int64_t store_checkpoints_written = 0;
  int64_t store_pending_writes = 0;
  bool store_failing = false;
};

}  // namespace ballpiston::server
