#include "server/book/job_message.h"

#include <algorithm>

#include "server/book/job_name.h"
#include "server/convert/spec.h"
#include "server/store/labels.h"

namespace ballpiston::server {
namespace {

// The latest time that a Timestamp can hold.
constexpr absl::Time kLastTime = absl::FromUnixSeconds(253'402'300'799);

void SetTimes(const JobRecord& record, double retain_days, v1::EnsembleJob& job) {
  SetTime(record.create_time, job.mutable_create_time());
  if (record.start_time) SetTime(*record.start_time, job.mutable_start_time());
  if (!record.end_time) return;
  SetTime(*record.end_time, job.mutable_end_time());
  if (retain_days == 0 || record.expired_time || record.pinned) return;
  const absl::Time expires = *record.end_time + absl::Hours(24) * retain_days;
  SetTime(std::min(expires, kLastTime), job.mutable_expire_time());
}

}  // namespace

void SetTime(absl::Time time, google::protobuf::Timestamp* timestamp) {
  const int64_t seconds = absl::ToUnixSeconds(time);
  timestamp->set_seconds(seconds);
  timestamp->set_nanos(
      static_cast<int32_t>(absl::ToInt64Nanoseconds(time - absl::FromUnixSeconds(seconds))));
}

v1::JobProgress ProgressOf(int64_t points, const v1::Target& target, const JobNumbers& numbers) {
  v1::JobProgress progress;
  progress.set_points(static_cast<int32_t>(points));
  progress.set_points_done(static_cast<int32_t>(numbers.points_done));
  progress.set_samples(numbers.samples);
  if (target.has_tolerance() || target.has_budget() || points == 0) return progress;
  const bool done = numbers.points_done == points;
  progress.set_fraction(
      done ? 1.0 : std::min(1.0, numbers.points_computed / static_cast<double>(points)));
  return progress;
}

v1::EnsembleJob JobMessage(const JobRecord& record, const JobNumbers& numbers, double retain_days) {
  v1::EnsembleJob job;
  job.set_name(JobName(record.id));
  *job.mutable_spec() = SpecFromBytes(record.spec).value_or(v1::EnsembleSpec());
  job.set_state(record.state);
  SetTimes(record, retain_days, job);
  if (!record.error.empty() && !job.mutable_error()->ParseFromString(record.error)) {
    job.clear_error();
  }
  *job.mutable_progress() = ProgressOf(record.points, job.spec().target(), numbers);
  job.set_engine_version(record.engine_version);
  job.set_work(numbers.work);
  job.set_principal(record.principal);
  job.set_priority(record.priority);
  job.set_pinned(record.pinned);
  if (!record.continues.empty()) job.set_continues(JobName(record.continues));
  job.set_continued_samples(record.continued_samples);
  for (const auto& [key, value] : LabelsOf(record.labels)) (*job.mutable_labels())[key] = value;
  job.set_results_expired(record.expired_time.has_value());
  job.set_stored_bytes(static_cast<double>(numbers.bytes));
  return job;
}

}  // namespace ballpiston::server
