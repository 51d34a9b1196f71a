#include "server/jobs/retention.h"

#include "absl/strings/str_cat.h"
#include "server/observability/log.h"
#include "server/store/job_table.h"
#include "server/store/sweeper.h"

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

// A job may have been pinned or deleted since it was found: then this has no effect on it.
absl::Status Retention::Remove(const std::vector<JobSize>& jobs, Removal removal, absl::Time now) {
  if (jobs.empty()) return absl::OkStatus();
  const bool whole = removal == Removal::kJob;
  const absl::Status committed = store_.CommitDeletion([&](Database& database) {
    absl::Status removed;
    for (size_t i = 0; removed.ok() && i < jobs.size(); ++i) {
      removed = whole ? DeleteJob(database, jobs[i].sequence)
                      : ExpireJob(database, jobs[i].sequence, now);
    }
    return removed;
  });
  if (committed.ok()) {
    LogInfo(absl::StrCat(whole ? "expired jobs were deleted: " : "results of jobs expired: ",
                         jobs.size()));
  }
  return committed;
}

}  // namespace ballpiston::server
