#include "server/store/sweeper.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "server/status/failpoint.h"

namespace ballpiston::server {
namespace {

void DropSome(Database& database, int64_t job) {
  database.Run(
      "DELETE FROM results WHERE rowid IN (SELECT rowid FROM results WHERE job = ? LIMIT ?)", job,
      kSweptRows);
  Failpoint("sweep.in_transaction");
  if (database.RowsChanged() == 0) database.Run("DELETE FROM dropped WHERE job = ?", job);
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
  const int64_t job = database.Integer("SELECT min(job) FROM dropped");
  if (job == 0) return ShortenFile(database);
  DropSome(database, job);
  return true;
}

bool IsSweeping(Database& database) { return database.Integer("SELECT count(*) FROM dropped") > 0; }

int64_t UsedBytes(Database& database) {
  const int64_t pages =
      database.Integer("PRAGMA page_count") - database.Integer("PRAGMA freelist_count");
  return pages * database.Integer("PRAGMA page_size");
}

}  // namespace ballpiston::server
