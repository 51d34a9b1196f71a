#include "server/store/sweeper.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/functional/function_ref.h"
#include "absl/strings/str_cat.h"
#include "server/observability/failpoint.h"

namespace ballpiston::server {
namespace {

using Clock = std::chrono::steady_clock;

// The size of a step is adapted so that it takes this long.
constexpr std::chrono::milliseconds kShortStep(10), kLongStep(20);
constexpr int64_t kLeast = 8, kMost = 1 << 14;
// Checkpoints that are replaced leave free pages, which the next checkpoints use.
constexpr int64_t kKeptPages = 256;

absl::Status InTransaction(Database& database, absl::FunctionRef<absl::Status()> change) {
  absl::Status status = database.Execute("BEGIN IMMEDIATE");
  if (!status.ok()) return status;
  status = change();
  if (status.ok()) status = database.Execute("COMMIT");
  if (!status.ok()) database.Execute("ROLLBACK").IgnoreError();
  return status;
}

// Adapts the step's size. On a full disk a smaller step may have room in the log.
absl::Status OneStep(Database& database, int64_t& size, absl::FunctionRef<absl::Status()> change) {
  const Clock::time_point begin = Clock::now();
  const absl::Status status = InTransaction(database, change);
  const bool is_too_large = absl::IsResourceExhausted(status) && size > kLeast;
  const Clock::duration took = Clock::now() - begin;
  if (is_too_large || took > kLongStep) {
    size = std::max(size / 2, kLeast);
  } else if (took < kShortStep) {
    size = std::min(size * 2, kMost);
  }
  return is_too_large ? absl::OkStatus() : status;
}

absl::Status DropSome(Database& database, int64_t job, int64_t most) {
  int64_t dropped = 0;
  for (const char* table : {"details", "results"}) {
    const absl::Status status =
        database
            .Prepare(absl::StrCat("DELETE FROM ", table, " WHERE rowid IN (SELECT rowid FROM ",
                                  table, " WHERE job = ? LIMIT ?)"))
            .Bind(job)
            .Bind(most - dropped)
            .Run();
    if (!status.ok()) return status;
    dropped += database.RowsChanged();
  }
  Failpoint("sweep.in_transaction");
  if (dropped > 0) return absl::OkStatus();
  return database.Prepare("DELETE FROM dropped WHERE job = ?").Bind(job).Run();
}

}  // namespace

absl::StatusOr<bool> Sweeper::Step(Database& database) {
  const absl::StatusOr<bool> dropped = DropRows(database);
  return dropped.ok() && !*dropped ? ShortenFile(database) : dropped;
}

absl::StatusOr<bool> Sweeper::DropRows(Database& database) {
  const auto job = database.Integer("SELECT min(job) FROM dropped");
  if (!job.ok()) return job.status();
  if (*job == 0) return false;
  if (std::exchange(job_, *job) != *job) rows_ = kFirstRows;
  const absl::Status status =
      OneStep(database, rows_, [&] { return DropSome(database, *job, rows_); });
  if (!status.ok()) return status;
  return true;
}

absl::StatusOr<bool> Sweeper::ShortenFile(Database& database) {
  const auto free = database.Integer("PRAGMA freelist_count");
  if (!free.ok()) return free.status();
  if (*free <= kKeptPages) return false;
  const int64_t pages = std::min(pages_, *free - kKeptPages);
  const absl::Status status = OneStep(database, pages_, [&] {
    return database.Execute(absl::StrCat("PRAGMA incremental_vacuum(", pages, ")"));
  });
  if (!status.ok()) return status;
  return true;
}

}  // namespace ballpiston::server
