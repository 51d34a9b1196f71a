#include "server/store/usage_table.h"

namespace ballpiston::server {

absl::StatusOr<std::vector<StoredUsage>> ReadStoredUsage(Database& database) {
  Query query =
      database.Prepare("SELECT principal, count(*), sum(bytes) FROM jobs GROUP BY principal");
  std::vector<StoredUsage> usage;
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return usage;
    usage.push_back({query.Bytes(0), query.Integer(1), query.Integer(2)});
  }
}

absl::StatusOr<std::vector<DayOfWork>> ReadWork(Database& database, int64_t first_day) {
  Query query = database.Prepare("SELECT principal, day, seconds FROM work WHERE day >= ?");
  query.Bind(first_day);
  std::vector<DayOfWork> work;
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return work;
    work.push_back({query.Bytes(0), query.Integer(1), query.Real(2)});
  }
}

absl::Status AddWork(Database& database, const DayOfWork& work) {
  return database
      .Prepare(
          "INSERT INTO work (principal, day, seconds) VALUES (?, ?, ?)"
          " ON CONFLICT DO UPDATE SET seconds = seconds + excluded.seconds")
      .BindText(work.principal)
      .Bind(work.day)
      .Bind(work.seconds)
      .Run();
}

absl::Status DropWorkBefore(Database& database, int64_t day) {
  return database.Prepare("DELETE FROM work WHERE day < ?").Bind(day).Run();
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

absl::StatusOr<bool> IsSweeping(Database& database) {
  const absl::StatusOr<int64_t> jobs = database.Integer("SELECT count(*) FROM dropped");
  if (!jobs.ok()) return jobs.status();
  return *jobs > 0;
}

}  // namespace ballpiston::server
