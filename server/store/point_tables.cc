#include "server/store/point_tables.h"

#include <utility>

namespace ballpiston::server {

absl::Status InsertBlock(Database& database, int64_t job, int64_t point, int64_t block,
                         const std::string& record) {
  return database
      .Prepare("INSERT OR IGNORE INTO blocks (job, point, block, record) VALUES (?, ?, ?, ?)")
      .Bind(job)
      .Bind(point)
      .Bind(block)
      .BindBlob(record)
      .Run();
}

absl::Status ReadBlocks(
    Database& database, int64_t job, int64_t point,
    const std::function<absl::Status(int64_t block, const std::string& record)>& on_block) {
  Query query = database.Prepare(
      "SELECT block, record FROM blocks WHERE job = ? AND point = ? ORDER BY block");
  query.Bind(job).Bind(point);
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return absl::OkStatus();
    const absl::Status taken = on_block(query.Integer(0), query.Bytes(1));
    if (!taken.ok()) return taken;
  }
}

absl::Status InsertResult(Database& database, int64_t job, const PointRow& row) {
  const absl::Status inserted =
      database
          .Prepare(
              "INSERT OR IGNORE INTO results (job, point, samples, result, finish) VALUES"
              " (?1, ?2, ?3, ?4, (SELECT coalesce(max(finish), 0) + 1 FROM results WHERE job = "
              "?1))")
          .Bind(job)
          .Bind(row.point)
          .Bind(row.samples)
          .BindBlob(row.result)
          .Run();
  if (!inserted.ok()) return inserted;
  return database.Prepare("DELETE FROM blocks WHERE job = ? AND point = ?")
      .Bind(job)
      .Bind(row.point)
      .Run();
}

absl::Status ReadResults(Database& database, int64_t job, int64_t first,
                         const std::function<bool(PointRow row)>& on_row) {
  Query query = database.Prepare(
      "SELECT point, samples, result FROM results WHERE job = ? AND point >= ? ORDER BY point");
  query.Bind(job).Bind(first);
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row || !on_row({query.Integer(0), query.Real(1), query.Bytes(2)})) {
      return absl::OkStatus();
    }
  }
}

absl::StatusOr<std::vector<PointRow>> ListFinishedPoints(Database& database, int64_t job) {
  Query query = database.Prepare("SELECT point, samples FROM results WHERE job = ? ORDER BY point");
  query.Bind(job);
  std::vector<PointRow> rows;
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return rows;
    rows.push_back({query.Integer(0), query.Real(1), std::string()});
  }
}

}  // namespace ballpiston::server
