#include "server/store/sweeper.h"

#include <algorithm>
#include <utility>

#include "absl/functional/function_ref.h"
#include "absl/strings/str_cat.h"
#include "server/observability/failpoint.h"

namespace ballpiston::server {
namespace {

// True, or the error of the change.
absl::StatusOr<bool> InTransaction(Database& database, absl::FunctionRef<absl::Status()> change) {
  absl::Status status = database.Execute("BEGIN IMMEDIATE");
  if (!status.ok()) return status;
  status = change();
  if (status.ok()) status = database.Execute("COMMIT");
  if (status.ok()) return true;
  database.Execute("ROLLBACK").IgnoreError();
  return status;
}

absl::Status DropSome(Database& database, int64_t job) {
  int64_t dropped = 0;
  for (const char* table : {"details", "results"}) {
    const absl::Status status =
        database.Run(absl::StrCat("DELETE FROM ", table, " WHERE rowid IN (SELECT rowid FROM ",
                                  table, " WHERE job = ? LIMIT ?)"),
                     job, kSweptRows - dropped);
    if (!status.ok()) return status;
    dropped += database.RowsChanged();
  }
  Failpoint("sweep.in_transaction");
  if (dropped > 0) return absl::OkStatus();
  return database.Run("DELETE FROM dropped WHERE job = ?", job);
}

absl::StatusOr<bool> ShortenFile(Database& database) {
  const auto free = database.Integer("PRAGMA freelist_count");
  if (!free.ok()) return free.status();
  if (*free <= kKeptPages) return false;
  const int64_t pages = std::min(kSweptPages, *free - kKeptPages);
  return InTransaction(database, [&] {
    return database.Execute(absl::StrCat("PRAGMA incremental_vacuum(", pages, ")"));
  });
}

}  // namespace

absl::StatusOr<bool> SweepStep(Database& database) {
  const auto job = database.Integer("SELECT min(job) FROM dropped");
  if (!job.ok()) return job.status();
  if (*job == 0) return ShortenFile(database);
  return InTransaction(database, [&] { return DropSome(database, *job); });
}

absl::StatusOr<bool> IsSweeping(Database& database) {
  const absl::StatusOr<int64_t> jobs = database.Integer("SELECT count(*) FROM dropped");
  if (!jobs.ok()) return jobs.status();
  return *jobs > 0;
}

absl::StatusOr<int64_t> UsedBytes(Database& database) {
  int64_t pages = 0;
  for (const auto& [sql, sign] :
       {std::pair{"PRAGMA page_count", 1}, std::pair{"PRAGMA freelist_count", -1}}) {
    const absl::StatusOr<int64_t> count = database.Integer(sql);
    if (!count.ok()) return count.status();
    pages += sign * *count;
  }
  const absl::StatusOr<int64_t> bytes = database.Integer("PRAGMA page_size");
  if (!bytes.ok()) return bytes.status();
  return pages * *bytes;
}

}  // namespace ballpiston::server
