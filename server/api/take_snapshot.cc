#include "server/api/take_snapshot.h"

#include <sys/stat.h>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "server/convert/spec.h"
#include "server/version.h"

namespace ballpiston::server {
namespace {

// 0 if there is no such file.
int64_t FileBytes(const std::string& path) {
  struct stat found {};
  return stat(path.c_str(), &found) == 0 ? int64_t{found.st_size} : 0;
}

void AddPrincipals(JobBook& book, ServerSnapshot& snapshot) {
  for (const auto& [principal, jobs] : book.JobsByPrincipal()) {
    snapshot.principals.push_back({.principal = principal,
                                   .queued_jobs = jobs.queued,
                                   .running_jobs = jobs.running + jobs.cancelling,
                                   .stored_jobs = jobs.stored,
                                   .stored_bytes = jobs.bytes});
    snapshot.queued_jobs += jobs.queued;
    snapshot.running_jobs += jobs.running;
    snapshot.cancelling_jobs += jobs.cancelling;
  }
}

void AddJobs(JobBook& book, ServerSnapshot& snapshot) {
  AddPrincipals(book, snapshot);
  snapshot.expiring_jobs = book.CountExpiring(absl::Now());
  const EndedJobs ended = book.ended_jobs();
  snapshot.jobs_succeeded = ended.succeeded;
  snapshot.jobs_failed = ended.failed;
  snapshot.jobs_cancelled = ended.cancelled;
}

void AddWork(const ServiceContext& service, ServerSnapshot& snapshot) {
  const ThreadCounts threads = service.threads.Counts();
  const WorkCounts work = service.scheduler.Counts();
  snapshot.workers = threads.workers;
  snapshot.busy_workers = threads.busy;
  snapshot.blocks_computed = threads.blocks;
  snapshot.samples_computed = work.samples;
  snapshot.processor_seconds = work.processor_seconds;
}

void AddStore(const ServiceContext& service, ServerSnapshot& snapshot) {
  snapshot.store_bytes =
      FileBytes(service.store_path) + FileBytes(absl::StrCat(service.store_path, "-wal"));
  const Store::Counts counts = service.store.counts();
  snapshot.store_commits = counts.commits;
  snapshot.store_checkpoints_written = counts.checkpoints_written;
  snapshot.store_pending_writes = counts.pending_writes;
  snapshot.store_failing = service.store.failing() || service.store.stalled();
}

}  // namespace

ServerSnapshot TakeSnapshot(const ServiceContext& service) {
  ServerSnapshot snapshot;
  snapshot.version = kVersion;
  snapshot.engine_version = EngineVersion();
  snapshot.start_time = service.start_time;
  snapshot.draining = service.draining;
  AddJobs(service.book, snapshot);
  AddWork(service, snapshot);
  snapshot.engine_crashes = service.book.engine_crashes();
  if (service.slurm != nullptr) snapshot.slurm = service.slurm->Status();
  AddStore(service, snapshot);
  snapshot.streams = static_cast<int64_t>(service.streams.size());
  return snapshot;
}

}  // namespace ballpiston::server
