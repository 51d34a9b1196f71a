#include "server/observability/metrics.h"

#include <limits>
#include <string>
#include <utility>

#include "absl/status/status.h"

namespace ballpiston::server {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

template <typename Number>
void Add(MetricFamily& family, Labels labels, Number value) {
  ClientMetric metric;
  metric.label = std::move(labels);
  (family.type == MetricType::Counter ? metric.counter.value : metric.gauge.value) =
      static_cast<double>(value);
  family.metric.push_back(std::move(metric));
}

template <typename Number>
MetricFamily One(std::string name, std::string help, MetricType type, Number value) {
  MetricFamily family{std::move(name), std::move(help), type, {}};
  Add(family, {}, value);
  return family;
}

template <typename Number>
MetricFamily Gauge(std::string name, std::string help, Number value) {
  return One(std::move(name), std::move(help), MetricType::Gauge, value);
}

template <typename Number>
MetricFamily Counter(std::string name, std::string help, Number value) {
  return One(std::move(name), std::move(help), MetricType::Counter, value);
}

double SinceEpoch(absl::Time time) { return absl::ToDoubleSeconds(time - absl::UnixEpoch()); }

MetricFamily ByReason(std::string name, std::string help,
                      const std::map<std::string, uint64_t>& counts) {
  MetricFamily family{std::move(name), std::move(help), MetricType::Counter, {}};
  for (const auto& [reason, count] : counts) Add(family, {{"reason", reason}}, count);
  return family;
}

MetricFamily BuildInfo(const ServerSnapshot& server) {
  MetricFamily family{"ballpiston_build_info", "Of this program; always 1.", MetricType::Gauge, {}};
  Add(family, {{"version", server.version}, {"engine_version", server.engine_version}}, 1);
  return family;
}

MetricFamily ActiveJobs(const ServerSnapshot& server) {
  MetricFamily family{
      "ballpiston_jobs", "Jobs that have not ended, by state.", MetricType::Gauge, {}};
  Add(family, {{"state", "queued"}}, server.queued_jobs);
  Add(family, {{"state", "running"}}, server.running_jobs);
  Add(family, {{"state", "cancelling"}}, server.cancelling_jobs);
  return family;
}

MetricFamily EndedJobs(const ServerSnapshot& server) {
  MetricFamily family{"ballpiston_jobs_ended_total",
                      "Jobs that ended, by their last state.",
                      MetricType::Counter,
                      {}};
  Add(family, {{"state", "succeeded"}}, server.jobs_succeeded);
  Add(family, {{"state", "failed"}}, server.jobs_failed);
  Add(family, {{"state", "cancelled"}}, server.jobs_cancelled);
  return family;
}

Labels MethodLabels(const MethodCounts::Totals& call) {
  return {{"grpc_service", call.service}, {"grpc_method", call.method}, {"grpc_type", call.type}};
}

void AddCodes(MetricFamily& family, const MethodCounts::Totals& call) {
  for (size_t code = 0; code < call.ended.size(); ++code) {
    Labels labels = MethodLabels(call);
    labels.push_back({"grpc_code", absl::StatusCodeToString(static_cast<absl::StatusCode>(code))});
    Add(family, std::move(labels), call.ended[code]);
  }
}

void AddHistogram(MetricFamily& family, const MethodCounts::Totals& call) {
  ClientMetric metric;
  metric.label = MethodLabels(call);
  uint64_t count = 0;
  for (size_t i = 0; i < call.durations.size(); ++i) {
    count += call.durations[i];
    const bool bounded = i < kDurationBounds.size();
    metric.histogram.bucket.push_back(
        {count, bounded ? kDurationBounds[i] : std::numeric_limits<double>::infinity()});
  }
  metric.histogram.sample_count = count;
  metric.histogram.sample_sum = call.seconds;
  family.metric.push_back(std::move(metric));
}

void AddSlurm(const SlurmStatus& slurm, std::vector<MetricFamily>& metrics) {
  MetricFamily tasks{"ballpiston_slurm_tasks",
                     "Tasks of job arrays, by state. submitted: since Slurm's last answer.",
                     MetricType::Gauge,
                     {}};
  Add(tasks, {{"state", "waiting"}}, slurm.waiting_tasks);
  Add(tasks, {{"state", "running"}}, slurm.running_tasks);
  Add(tasks, {{"state", "submitted"}}, slurm.submitted_tasks);
  metrics.push_back(std::move(tasks));
  metrics.push_back(Gauge("ballpiston_slurm_failing", "1 while nothing can be submitted.",
                          !slurm.problem.empty()));
  metrics.push_back(Counter("ballpiston_slurm_chunks_total", "Chunks received.", slurm.chunks));
  metrics.push_back(Counter("ballpiston_slurm_lost_tasks_total",
                            "Tasks that ended without their last file.", slurm.lost_tasks));
  metrics.push_back(Counter("ballpiston_slurm_refused_files_total",
                            "Files with chunks that were damaged or of another job.",
                            slurm.refused_files));
  metrics.push_back(
      Counter("ballpiston_slurm_queries_total", "Queries of Slurm's queue.", slurm.queries));
}

}  // namespace

std::vector<MetricFamily> CallMetrics(const std::vector<MethodCounts::Totals>& calls) {
  MetricFamily began{"grpc_server_started_total", "Calls that began.", MetricType::Counter, {}};
  MetricFamily ended{
      "grpc_server_handled_total", "Calls that ended, by code.", MetricType::Counter, {}};
  MetricFamily seconds{
      "grpc_server_handling_seconds", "From a call's begin to its end.", MetricType::Histogram, {}};
  for (const MethodCounts::Totals& call : calls) {
    Add(began, MethodLabels(call), call.began);
    AddCodes(ended, call);
    AddHistogram(seconds, call);
  }
  return {std::move(began), std::move(ended), std::move(seconds)};
}

std::vector<MetricFamily> ServerMetrics(const ServerSnapshot& server) {
  std::vector<MetricFamily> metrics = {
      BuildInfo(server),
      Gauge("ballpiston_start_time_seconds", "When the server started, since 1970.",
            SinceEpoch(server.start_time)),
      Gauge("ballpiston_draining", "1 while the server is stopping.", server.draining),
      ActiveJobs(server),
      EndedJobs(server),
      Gauge("ballpiston_queue_length", "Jobs that wait for their first turn.", server.queued_jobs),
      Gauge("ballpiston_workers", "Threads that compute.", server.workers),
      Gauge("ballpiston_busy_workers", "Those that compute now.", server.busy_workers),
      Counter("ballpiston_blocks_computed_total", "Blocks of samples.", server.blocks_computed),
      Counter("ballpiston_samples_computed_total", "Samples in them.", server.samples_computed),
      Counter("ballpiston_processor_seconds_total", "Processor time of threads and cluster.",
              server.processor_seconds),
      Gauge("ballpiston_streams", "Open watches.", server.streams),
      Gauge("ballpiston_store_bytes", "The store on disk, its log included.", server.store_bytes),
      Counter("ballpiston_store_commits_total", "Groups of writes on disk.", server.store_commits),
      Counter("ballpiston_store_checkpoints_written_total",
              "Checkpoints of unfinished points on disk.", server.store_checkpoints_written),
      Gauge("ballpiston_store_pending_writes", "What waits to be written.",
            server.store_pending_writes),
      Gauge("ballpiston_store_failing", "1 while the disk refuses writes.", server.store_failing),
      ByReason("ballpiston_failed_authentications_total",
               "Calls without the credentials or the role they need.",
               server.failed_authentications),
      ByReason("ballpiston_limit_refusals_total", "Calls refused because a limit was reached.",
               server.limit_refusals),
  };
  if (server.slurm) AddSlurm(*server.slurm, metrics);
  if (server.certificate_expiry) {
    metrics.push_back(Gauge("ballpiston_certificate_expiry_timestamp_seconds",
                            "Until when the server's certificate is valid, since 1970.",
                            SinceEpoch(*server.certificate_expiry)));
  }
  return metrics;
}

}  // namespace ballpiston::server
