// How long results are kept: Limits::retain_days and Limits::max_store_bytes.
//
// The results of a job that is not pinned expire `retain_days` after its end. If the store takes
// more than kFullShare of its bound, results expire earlier: those of the principal with the most
// stored bytes, beginning with the job that ended first. If none of its results can expire, its
// expired jobs are deleted in the same order; then the next principal follows. So the
// results of the principal that stores most expire first.
// The data of active and pinned jobs are never removed here, so the store may grow beyond the
// bound; if they alone, without their checkpoints, exceed it, no new job is accepted
// (acceptance.h).
#include <algorithm>
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

// Of a commit, which other writes wait for: each row is written anew, with its grid.
constexpr int kMostAtOnce = 256;
constexpr int64_t kMostBytesAtOnce = 8 << 20;
constexpr absl::Duration kSoonToExpire = absl::Hours(7 * 24);

// Space is freed before the bound is reached, so that the store seldom exceeds it.
constexpr double kFullShare = 0.95;

struct Removal {
  Removable what = Removable::kResults;
  std::vector<JobSize> jobs = {};
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
  const absl::Time ended = now - absl::Hours(24) * limits.retain_days;
  auto jobs = ListRemovable(database, Removable::kResults, ended, "", kMostAtOnce);
  return {.jobs = EnoughOf(std::move(jobs), kMostBytesAtOnce)};
}

// Rows that the sweeper has still to remove take pages, so nothing more expires meanwhile.
Removal TooMuch(Database& database, const Limits& limits) {
  if (limits.max_store_bytes == 0 || IsSweeping(database)) return {};
  const auto most = static_cast<int64_t>(kFullShare * static_cast<double>(limits.max_store_bytes));
  const int64_t excess = std::min(UsedBytes(database) - most, kMostBytesAtOnce);
  if (excess <= 0) return {};
  for (const std::string& principal : PrincipalsBySize(database)) {
    for (const Removable what : {Removable::kResults, Removable::kJobs}) {
      auto jobs = ListRemovable(database, what, absl::InfiniteFuture(), principal, kMostAtOnce);
      if (!jobs.empty()) return {what, EnoughOf(std::move(jobs), excess)};
    }
  }
  return {};
}

// A job may have been pinned or deleted since it was found: then this has no effect on it.
absl::StatusOr<size_t> Remove(Store& store, const Removal& removal) {
  return store.CommitDeletion([&](Database& database) {
    for (const JobSize& job : removal.jobs) {
      (removal.what == Removable::kJobs ? DeleteJob : ExpireJob)(database, job.sequence);
    }
    return removal.jobs.size();
  });
}

}  // namespace

absl::StatusOr<size_t> JobBook::EnforceRetention(absl::Time now) {
  const auto removal = store_.Read([&](Database& database) {
    Removal old = TooOld(database, limits_, now);
    return old.jobs.empty() ? TooMuch(database, limits_) : old;
  });
  if (!removal.ok()) return removal.status();
  return removal->jobs.empty() ? size_t{0} : Remove(store_, *removal);
}

void JobBook::KeepLimits(absl::Time now) {
  absl::StatusOr<size_t> removed;
  size_t all = 0;
  do {
    removed = EnforceRetention(now);
    all += removed.value_or(0);
  } while (removed.value_or(0) > 0 && store_.AwaitSwept());
  if (all > 0) LogInfo(absl::StrCat("results expired or expired jobs were deleted: ", all));
  const absl::Status kept = removed.status();
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
