#include "server/jobs/job_message.h"

#include "server/jobs/job_name.h"

namespace ballpiston::server {
namespace {

void SetProgress(const JobRecord& record, v1::EnsembleJob& job) {
  v1::JobProgress& progress = *job.mutable_progress();
  progress.set_points(static_cast<int32_t>(record.points));
  progress.set_points_done(static_cast<int32_t>(record.points_done));
  progress.set_samples(record.samples);
  if (IsOpenEnded(job.spec().target()) || record.points == 0) return;
  progress.set_fraction(static_cast<double>(record.points_done) /
                        static_cast<double>(record.points));
}

}  // namespace

void SetTime(absl::Time time, google::protobuf::Timestamp* timestamp) {
  const int64_t seconds = absl::ToUnixSeconds(time);
  timestamp->set_seconds(seconds);
  timestamp->set_nanos(
      static_cast<int32_t>(absl::ToInt64Nanoseconds(time - absl::FromUnixSeconds(seconds))));
}

bool IsOpenEnded(const v1::Target& target) { return target.has_tolerance() || target.has_budget(); }

v1::EnsembleJob JobMessage(const JobRecord& record) {
  v1::EnsembleJob job;
  if (!record.id.empty()) job.set_name(JobName(record.id));
  if (!job.mutable_spec()->ParseFromString(record.spec)) job.clear_spec();
  job.set_state(record.state);
  SetTime(record.create_time, job.mutable_create_time());
  if (record.start_time) SetTime(*record.start_time, job.mutable_start_time());
  if (record.end_time) SetTime(*record.end_time, job.mutable_end_time());
  if (!record.error.empty() && !job.mutable_error()->ParseFromString(record.error)) {
    job.clear_error();
  }
  SetProgress(record, job);
  job.set_engine_version(record.engine_version);
  job.set_work(record.work);
  job.set_principal(record.principal);
  job.set_priority(record.priority);
  job.set_pinned(record.pinned);
  job.set_results_expired(record.expired_time.has_value());
  job.set_stored_bytes(static_cast<double>(record.bytes));
  return job;
}

}  // namespace ballpiston::server
