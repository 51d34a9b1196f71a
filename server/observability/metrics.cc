#include "server/observability/metrics.h"

#include <algorithm>
#include <string>

#include "prometheus/counter.h"
#include "prometheus/gauge.h"
#include "prometheus/registry.h"

namespace ballpiston::server {
namespace {

using prometheus::Labels;
using prometheus::MetricFamily;

// The numbers of one scrape. A name that is used again adds to the same family.
class Page {
 public:
  template <typename Number>
  void Gauge(const std::string& name, const std::string& help, Number value,
             const Labels& labels = {}) {
    prometheus::BuildGauge().Name(name).Help(help).Register(registry_).Add(labels).Set(
        static_cast<double>(value));
  }

  template <typename Number>
  void Counter(const std::string& name, const std::string& help, Number value,
               const Labels& labels = {}) {
    prometheus::BuildCounter().Name(name).Help(help).Register(registry_).Add(labels).Increment(
        static_cast<double>(value));
  }

  std::vector<MetricFamily> Families() const { return registry_.Collect(); }

 private:
  prometheus::Registry registry_;
};

double SinceEpoch(absl::Time time) { return absl::ToDoubleSeconds(time - absl::UnixEpoch()); }

void AddServer(const ServerSnapshot& server, Page& page) {
  page.Gauge("ballpiston_build_info", "Versions of this program; always 1.", 1,
             {{"version", server.version}, {"engine_version", server.engine_version}});
  page.Gauge("ballpiston_start_time_seconds", "Start time of the server, in seconds since 1970.",
             SinceEpoch(server.start_time));
  page.Gauge("ballpiston_draining", "1 while the server is stopping.", server.draining);
  page.Counter("ballpiston_engine_crashes_total",
               "Deaths of server processes on this data folder while they computed: crashes of the "
               "engine, and kills for want of memory.",
               server.engine_crashes);
  page.Gauge("ballpiston_streams", "Open watches and traces.", server.streams);
  if (server.certificate_expiry) {
    page.Gauge("ballpiston_certificate_expiry_timestamp_seconds",
               "Expiry of the server's certificate, in seconds since 1970.",
               SinceEpoch(*server.certificate_expiry));
  }
}

void AddJobs(const ServerSnapshot& server, Page& page) {
  const std::string active = "Jobs that have not ended, by state.";
  page.Gauge("ballpiston_jobs", active, server.queued_jobs, {{"state", "queued"}});
  page.Gauge("ballpiston_jobs", active, server.running_jobs, {{"state", "running"}});
  page.Gauge("ballpiston_jobs", active, server.cancelling_jobs, {{"state", "cancelling"}});
  const std::string ended = "Jobs that ended, by their last state.";
  page.Counter("ballpiston_jobs_ended_total", ended, server.jobs_succeeded,
               {{"state", "succeeded"}});
  page.Counter("ballpiston_jobs_ended_total", ended, server.jobs_failed, {{"state", "failed"}});
  page.Counter("ballpiston_jobs_ended_total", ended, server.jobs_cancelled,
               {{"state", "cancelled"}});
  page.Gauge("ballpiston_queue_length", "Jobs that wait for their first turn.", server.queued_jobs);
}

void AddWork(const ServerSnapshot& server, Page& page) {
  page.Gauge("ballpiston_workers", "Threads that compute.", server.workers);
  page.Gauge("ballpiston_busy_workers", "Threads that compute now.", server.busy_workers);
  page.Counter("ballpiston_blocks_computed_total", "Computed blocks of samples.",
               server.blocks_computed);
  page.Counter("ballpiston_samples_computed_total", "Computed samples.", server.samples_computed);
  page.Counter("ballpiston_processor_seconds_total", "Processor time of threads and cluster.",
               server.processor_seconds);
}

void AddStore(const ServerSnapshot& server, Page& page) {
  page.Gauge("ballpiston_store_bytes", "The store on disk, its log included.", server.store_bytes);
  page.Counter("ballpiston_store_commits_total", "Committed groups of writes.",
               server.store_commits);
  page.Counter("ballpiston_store_checkpoints_written_total",
               "Checkpoints of unfinished points that were written.",
               server.store_checkpoints_written);
  page.Gauge("ballpiston_store_pending_writes", "Writes that wait.", server.store_pending_writes);
  page.Gauge("ballpiston_expiring_jobs", "Jobs whose results expire within a week.",
             server.expiring_jobs);
  page.Gauge("ballpiston_store_failing", "1 while the disk rejects writes or hangs.",
             server.store_failing);
}

void AddPrincipals(const ServerSnapshot& server, Page& page) {
  const size_t count = std::min(server.principals.size(), kMostPrincipals);
  for (size_t i = 0; i < count; ++i) {
    const PrincipalSnapshot& of_one = server.principals[i];
    const Labels labels = {{"principal", of_one.principal}};
    page.Gauge("ballpiston_principal_stored_jobs", "Stored jobs, including ended ones.",
               of_one.stored_jobs, labels);
    page.Gauge("ballpiston_principal_stored_bytes", "Bytes of stored specifications and results.",
               of_one.stored_bytes, labels);
  }
}

void AddSlurm(const SlurmStatus& slurm, Page& page) {
  const std::string tasks = "Tasks of job arrays, by state. submitted: since Slurm's last answer.";
  page.Gauge("ballpiston_slurm_tasks", tasks, slurm.waiting_tasks, {{"state", "waiting"}});
  page.Gauge("ballpiston_slurm_tasks", tasks, slurm.running_tasks, {{"state", "running"}});
  page.Gauge("ballpiston_slurm_tasks", tasks, slurm.submitted_tasks, {{"state", "submitted"}});
  page.Gauge("ballpiston_slurm_failing", "1 while nothing can be submitted.",
             !slurm.problem.empty());
  page.Counter("ballpiston_slurm_chunks_total", "Chunks received.", slurm.chunks);
  page.Counter("ballpiston_slurm_lost_tasks_total", "Tasks that ended without their last file.",
               slurm.lost_tasks);
  page.Counter("ballpiston_slurm_refused_files_total",
               "Files with chunks that were damaged or of another job.", slurm.refused_files);
  page.Counter("ballpiston_slurm_queries_total", "Queries of Slurm's queue.", slurm.queries);
}

}  // namespace

std::vector<MetricFamily> ServerMetrics(const ServerSnapshot& server) {
  Page page;
  AddServer(server, page);
  AddJobs(server, page);
  AddWork(server, page);
  AddStore(server, page);
  AddPrincipals(server, page);
  if (server.slurm) AddSlurm(*server.slurm, page);
  return page.Families();
}

}  // namespace ballpiston::server
