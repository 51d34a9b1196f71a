#include <algorithm>
#include <string>

#include "absl/strings/ascii.h"
#include "prometheus/counter.h"
#include "prometheus/gauge.h"
#include "prometheus/registry.h"
#include "server/rpc/server_status.h"

namespace ballpiston::server {
namespace {

using prometheus::Labels;

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

  std::vector<prometheus::MetricFamily> Families() const { return registry_.Collect(); }

 private:
  prometheus::Registry registry_;
};

double SinceEpoch(absl::Time time) { return absl::ToDoubleSeconds(time - absl::UnixEpoch()); }

void AddServer(const ServiceContext& service, const v1::ServerStatus& status, Page& page) {
  page.Gauge("ballpiston_build_info", "Versions of this program; always 1.", 1,
             {{"version", status.version()}, {"engine_version", status.engine_version()}});
  page.Gauge("ballpiston_start_time_seconds", "Start time of the server, in seconds since 1970.",
             SinceEpoch(service.start_time));
  page.Counter("ballpiston_engine_crashes_total",
               "Deaths of server processes on this data folder while they computed: crashes of the "
               "engine, and kills for want of memory.",
               service.book.engine_crashes());
  if (service.device != nullptr) {
    page.Gauge("ballpiston_device_failed",
               "1 after the GPU failed: the processor computes until the next start.",
               service.device->has_failed());
  }
  page.Gauge("ballpiston_streams", "Open watches and traces.", status.streams());
  page.Gauge("ballpiston_workers", "Threads that compute.", status.workers());
  page.Gauge("ballpiston_busy_workers", "Threads that compute now.", status.busy_workers());
  page.Counter("ballpiston_samples_computed_total", "Computed samples.", status.samples_computed());
  page.Counter("ballpiston_processor_seconds_total", "Processor time of threads and cluster.",
               status.processor_seconds());
}

void AddJobs(const JobBook& book, const v1::ServerStatus& status, Page& page) {
  const std::string help = "Jobs that have not ended, by state. running: or being cancelled.";
  page.Gauge("ballpiston_jobs", help, status.queued_jobs(), {{"state", "queued"}});
  page.Gauge("ballpiston_jobs", help, status.running_jobs(), {{"state", "running"}});
  for (const auto& [state, jobs] : book.ended_jobs()) {
    page.Counter("ballpiston_jobs_ended_total", "Jobs that ended, by their last state.", jobs,
                 {{"state", absl::AsciiStrToLower(v1::EnsembleJob::State_Name(state))}});
  }
  page.Gauge("ballpiston_expiring_jobs", "Jobs whose results expire within a week.",
             status.expiring_jobs());
}

void AddStore(const Store& store, const v1::ServerStatus& status, Page& page) {
  const Store::Counts counts = store.counts();
  page.Gauge("ballpiston_store_bytes", "The store on disk, its log included.",
             status.store_bytes());
  page.Counter("ballpiston_store_checkpoints_written_total",
               "Checkpoints of unfinished points that were written.", counts.checkpoints_written);
  page.Gauge("ballpiston_store_pending_writes", "Writes that wait.", counts.pending_writes);
  page.Gauge("ballpiston_store_failing", "1 while the disk rejects writes or hangs.",
             store.failing() || store.stalled());
}

void AddPrincipals(const v1::ServerStatus& status, Page& page) {
  const size_t count = std::min(static_cast<size_t>(status.principals_size()), kMostPrincipals);
  for (size_t i = 0; i < count; ++i) {
    const v1::PrincipalStatus& usage = status.principals(static_cast<int>(i));
    const Labels labels = {{"principal", usage.principal()}};
    page.Gauge("ballpiston_principal_stored_jobs", "Stored jobs, including ended ones.",
               usage.stored_jobs(), labels);
    page.Gauge("ballpiston_principal_stored_bytes", "Bytes of stored specifications and results.",
               usage.stored_bytes(), labels);
  }
}

void AddCluster(const v1::ClusterStatus& cluster, Page& page) {
  const std::string leases = "Leases in the cluster's folder, by state.";
  page.Gauge("ballpiston_cluster_leases", leases, cluster.waiting_leases(), {{"state", "waiting"}});
  page.Gauge("ballpiston_cluster_leases", leases, cluster.taken_leases(), {{"state", "taken"}});
  const std::string workers = "Workers in Slurm's queue, by state.";
  page.Gauge("ballpiston_cluster_workers", workers, cluster.waiting_workers(),
             {{"state", "waiting"}});
  page.Gauge("ballpiston_cluster_workers", workers, cluster.running_workers(),
             {{"state", "running"}});
  page.Gauge("ballpiston_cluster_failing", "1 while the folder or Slurm cannot be used.",
             !cluster.problem().empty());
  page.Counter("ballpiston_cluster_chunks_total", "Chunks received.", cluster.chunks());
  page.Counter("ballpiston_cluster_lost_leases_total",
               "Leases whose workers were silent for too long.", cluster.lost_leases());
  page.Counter("ballpiston_cluster_refused_files_total",
               "Files that were damaged or of another server.", cluster.refused_files());
  page.Counter("ballpiston_cluster_queries_total", "Queries of Slurm's queue.", cluster.queries());
}

}  // namespace

std::vector<prometheus::MetricFamily> ServerMetrics(const ServiceContext& service,
                                                    std::optional<absl::Time> certificate_expiry) {
  const v1::ServerStatus status = StatusOf(service, LocalPrincipal());
  Page page;
  AddServer(service, status, page);
  AddJobs(service.book, status, page);
  AddStore(service.store, status, page);
  AddPrincipals(status, page);
  if (status.has_cluster()) AddCluster(status.cluster(), page);
  if (certificate_expiry) {
    page.Gauge("ballpiston_certificate_expiry_timestamp_seconds",
               "Expiry of the server's certificate, in seconds since 1970.",
               SinceEpoch(*certificate_expiry));
  }
  return page.Families();
}

}  // namespace ballpiston::server
