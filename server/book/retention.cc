// How long results are kept: Limits::retain_days and Limits::max_store_bytes.
//
// The results of a job that is not pinned expire `retain_days` after its end. If the store takes
// more than kFullShare of its bound, results expire earlier, beginning with the job that ended
// first. If no results are left that can expire, the expired jobs are deleted in the same order.
// The data of active and pinned jobs are never removed here, so the store may grow beyond the
// bound; if they alone exceed it, no new job is accepted (acceptance.h).
#include <cstdint>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/book/job_book.h"
#include "server/status/log.h"
#include "server/store/job_table.h"
#include "server/store/sweeper.h"

namespace ballpiston::server {
namespace {

constexpr int kMostAtOnce = 256;
constexpr absl::Duration kSoonToExpire = absl::Hours(7 * 24);

// Space is freed before the bound is reached, so that the store seldom exceeds it.
constexpr double kFullShare = 0.95;

struct Removal {
  std::vector<JobSize> jobs = {};
  bool whole = false;  // the jobs, not only their results
};

// The first jobs that together take `bytes` or more; all jobs if they take less.
std::vector<JobSize> EnoughOf(std::vector<JobSize> jobs, int64_t bytes) {
  size_t count = 0;
  while (count < jobs.size() && bytes > 0) bytes -= jobs[count++].bytes;
  jobs.resize(count);
  return jobs;
}

Removal TooOld(Database& database, const Limits& limits, absl::Time now) {
  if (limits.retain_days == 0) return {};
  return {ListExpirable(database, now - absl::Hours(24) * limits.retain_days, kMostAtOnce)};
}

// Rows that the sweeper has still to remove take pages, so nothing more expires meanwhile.
Removal TooMuch(Database& database, const Limits& limits) {
  if (limits.max_store_bytes == 0 || IsSweeping(database)) return {};
  const auto most = static_cast<int64_t>(kFullShare * static_cast<double>(limits.max_store_bytes));
  const int64_t used = UsedBytes(database);
  if (used <= most) return {};
  auto jobs = ListExpirable(database, absl::InfiniteFuture(), kMostAtOnce);
  const bool whole = jobs.empty();
  if (whole) jobs = ListExpired(database, kMostAtOnce);
  return {EnoughOf(std::move(jobs), used - most), whole};
}

// A job may have been pinned or deleted since it was found: then this has no effect on it.
absl::Status Remove(Store& store, const Removal& removal, absl::Time now) {
  if (removal.jobs.empty()) return absl::OkStatus();
  const absl::Status committed = store.CommitDeletion([&](Database& database) {
    for (const JobSize& job : removal.jobs) {
      if (removal.whole) DeleteJob(database, job.sequence);
      if (!removal.whole) ExpireJob(database, job.sequence, now);
    }
  });
  if (committed.ok()) {
    LogInfo(
        absl::StrCat(removal.whole ? "expired jobs were deleted: " : "results of jobs expired: ",
                     removal.jobs.size()));
  }
  return committed;
}

}  // namespace

absl::Status JobBook::EnforceRetention(absl::Time now) {
  const auto old = store_.Read([&](Database& database) { return TooOld(database, limits_, now); });
  if (!old.ok()) return old.status();
  const absl::Status aged = Remove(store_, *old, now);
  if (!aged.ok()) return aged;
  const auto much = store_.Read([&](Database& database) { return TooMuch(database, limits_); });
  return much.ok() ? Remove(store_, *much, now) : much.status();
}

void JobBook::KeepLimits(absl::Time now) {
  const absl::Status kept = EnforceRetention(now);
  const bool is_new = std::exchange(limits_failure_, kept) != kept;
  if (is_new && !kept.ok() && !store_.failing()) {
    LogError(absl::StrCat("the limits on stored results cannot be enforced: ", kept.message()));
  }
}

int64_t JobBook::CountExpiring(absl::Time now) {
  if (limits_.retain_days == 0) return 0;
  const absl::Time ended = now + kSoonToExpire - absl::Hours(24) * limits_.retain_days;
  return store_.Read([&](Database& database) { return CountExpirable(database, ended); })
      .value_or(0);
}

}  // namespace ballpiston::server
