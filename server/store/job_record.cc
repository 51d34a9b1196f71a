#include "server/store/job_record.h"

#include <algorithm>

#include "absl/time/time.h"
#include "server/convert/timestamp.h"

namespace ballpiston::server {
namespace {

// The latest time that a Timestamp can hold.
constexpr absl::Time kLastTime = absl::FromUnixSeconds(253'402'300'799);

// A job's row, and its entries in the indices, without the specification and the labels.
constexpr int64_t kJobRow = 540;

}  // namespace

int64_t BytesOfJob(const v1::EnsembleJob& job) {
  size_t bytes = job.spec().ByteSizeLong();
  for (const auto& [key, value] : job.labels()) bytes += key.size() + value.size();
  return kJobRow + static_cast<int64_t>(bytes);
}

v1::JobProgress ProgressOf(const v1::EnsembleJob& job, const JobNumbers& numbers) {
  const v1::Target& target = job.spec().target();
  const int32_t points = job.progress().points();
  v1::JobProgress progress;
  progress.set_points(points);
  progress.set_points_done(static_cast<int32_t>(numbers.points_done));
  progress.set_samples(numbers.samples);
  if (target.has_tolerance() || target.has_budget() || points == 0) return progress;
  const bool done = numbers.points_done == points;
  progress.set_fraction(done ? 1.0 : std::min(1.0, numbers.points_computed / points));
  return progress;
}

void SetNumbers(const JobNumbers& numbers, v1::EnsembleJob& job) {
  *job.mutable_progress() = ProgressOf(job, numbers);
  job.set_work(numbers.work);
  job.set_stored_bytes(static_cast<double>(numbers.bytes));
}

int64_t StoredBytesOf(const v1::EnsembleJob& job) {
  constexpr double kMost = 1e18;
  const double bytes = job.stored_bytes();
  return bytes >= 0 && bytes <= kMost ? static_cast<int64_t>(bytes) : 0;
}

void SetExpireTime(double retain_days, v1::EnsembleJob& job) {
  job.clear_expire_time();
  if (retain_days == 0 || !job.has_end_time() || job.results_expired() || job.pinned()) return;
  const absl::Time expires = TimeOf(job.end_time()) + absl::Hours(24) * retain_days;
  SetTime(std::min(expires, kLastTime), job.mutable_expire_time());
}

}  // namespace ballpiston::server
