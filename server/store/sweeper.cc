#include "server/store/sweeper.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "server/status/failpoint.h"

namespace ballpiston::server {
namespace {

// Removes rows of the first jobs, and forgets those of the jobs that have no row left.
void DropSome(Database& database) {
  const std::string first = "(SELECT job FROM dropped ORDER BY job LIMIT ?1)";
  database.Run(absl::StrCat("DELETE FROM results WHERE rowid IN (SELECT results.rowid FROM ", first,
                            " JOIN results USING (job) LIMIT ?1)"),
               kSweptRows);
  Failpoint("sweep.in_transaction");
  database.Run(
      absl::StrCat("DELETE FROM dropped WHERE job IN ", first,
                   " AND NOT EXISTS (SELECT 1 FROM results WHERE results.job = dropped.job)"),
      kSweptRows);
}

bool ShortenFile(Database& database) {
  const int64_t free = database.Integer("PRAGMA freelist_count");
  if (free <= kKeptPages) return false;
  const int64_t pages = std::min(kSweptPages, free - kKeptPages);
  database.Execute(absl::StrCat("PRAGMA incremental_vacuum(", pages, ")"));
  return true;
}

}  // namespace

bool SweepStep(Database& database) {
  if (!IsSweeping(database)) return ShortenFile(database);
  DropSome(database);
  return true;
}

bool IsSweeping(Database& database) { return database.Integer("SELECT min(job) FROM dropped") > 0; }

int64_t UsedBytes(Database& database) {
  const int64_t pages =
      database.Integer("PRAGMA page_count") - database.Integer("PRAGMA freelist_count");
  return pages * database.Integer("PRAGMA page_size");
}

}  // namespace ballpiston::server
