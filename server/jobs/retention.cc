#include "server/jobs/retention.h"

#include <optional>

#include "absl/strings/str_cat.h"
#include "server/observability/log.h"
#include "server/store/job_table.h"

namespace ballpiston::server {
namespace {

constexpr int kMostAtOnce = 256;

// The first jobs that together take `bytes` or more; all jobs if they take less.
std::vector<JobSize> EnoughOf(std::vector<JobSize> jobs, int64_t bytes) {
  size_t count = 0;
  while (count < jobs.size() && bytes > 0) bytes -= jobs[count++].bytes;
  jobs.resize(count);
  return jobs;
}

}  // namespace

absl::Status Retention::Enforce(absl::Time now) {
  const absl::Status aged = EnforceAge(now);
  return aged.ok() ? EnforceSize(now) : aged;
}

absl::Status Retention::EnforceAge(absl::Time now) {
  if (limits_.retain_days == 0) return absl::OkStatus();
  absl::StatusOr<std::vector<JobSize>> old;
  const absl::Status read = store_.Read([&](Database& database) {
    old = ListExpirable(database, now - absl::Hours(24) * limits_.retain_days, kMostAtOnce);
    return old.status();
  });
  return read.ok() ? Remove(*old, Removal::kResults, now) : read;
}

// Rows that the sweeper has still to remove take pages, so nothing more expires meanwhile.
absl::Status Retention::EnforceSize(absl::Time now) {
  if (limits_.max_store_bytes == 0) return absl::OkStatus();
  std::vector<JobSize> jobs;
  Removal removal = Removal::kResults;
  const absl::Status read = store_.Read([&](Database& database) {
    const absl::StatusOr<bool> sweeping = IsSweeping(database);
    if (!sweeping.ok() || *sweeping) return sweeping.status();
    const absl::StatusOr<int64_t> used = UsedBytes(database);
    if (!used.ok()) return used.status();
    const auto most =
        static_cast<int64_t>(kFullShare * static_cast<double>(limits_.max_store_bytes));
    if (*used <= most) return absl::OkStatus();
    auto found = ListExpirable(database, absl::InfiniteFuture(), kMostAtOnce);
    if (found.ok() && found->empty()) {
      removal = Removal::kJob;
      found = ListExpired(database, kMostAtOnce);
    }
    if (found.ok()) jobs = EnoughOf(*std::move(found), *used - most);
    return found.status();
  });
  return read.ok() ? Remove(jobs, removal, now) : read;
}

// A job may have been pinned or deleted since it was found.
absl::Status Retention::Remove(const std::vector<JobSize>& jobs, Removal removal, absl::Time now) {
  if (jobs.empty()) return absl::OkStatus();
  const bool whole = removal == Removal::kJob;
  std::vector<JobSize> removed;
  const auto remove = [&](Database& database) -> absl::Status {
    removed.clear();
    for (const JobSize& found : jobs) {
      const absl::StatusOr<std::optional<JobSize>> job = FindUnpinned(database, found.sequence);
      if (!job.ok()) return job.status();
      if (!*job) continue;
      const absl::Status changed =
          whole ? DeleteJob(database, found.sequence) : ExpireJob(database, found.sequence, now);
      if (!changed.ok()) return changed;
      removed.push_back(**job);
    }
    return absl::OkStatus();
  };
  const auto count = [&](const absl::Status& done) {
    if (!done.ok()) return;
    for (const JobSize& job : removed) {
      const int64_t left = whole ? 0 : job.spec_bytes;
      usage_.AddStored(job.principal, whole ? -1 : 0, left - job.bytes);
    }
  };
  const absl::Status committed = store_.CommitDeletion(remove, count);
  if (committed.ok() && !removed.empty()) {
    LogInfo(absl::StrCat(whole ? "expired jobs were deleted: " : "results of jobs expired: ",
                         removed.size()));
  }
  return committed;
}

}  // namespace ballpiston::server
