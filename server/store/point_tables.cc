#include "server/store/point_tables.h"

#include <utility>

namespace ballpiston::server {

namespace {

absl::Status DropOfPoint(Database& database, const char* sql, int64_t job, int64_t point) {
  return database.Prepare(sql).Bind(job).Bind(point).Run();
}

}  // namespace

absl::Status WriteCheckpoint(Database& database, int64_t job, int64_t point, int64_t chunk,
                             const std::string& record) {
  const absl::Status dropped =
      database.Prepare("DELETE FROM chunks WHERE job = ? AND point = ? AND chunk < ?")
          .Bind(job)
          .Bind(point)
          .Bind(chunk)
          .Run();
  if (!dropped.ok()) return dropped;
  return database
      .Prepare("INSERT OR REPLACE INTO checkpoints (job, point, record) VALUES (?, ?, ?)")
      .Bind(job)
      .Bind(point)
      .BindBlob(record)
      .Run();
}

absl::Status InsertChunk(Database& database, int64_t job, int64_t point, int64_t chunk,
                         const std::string& record) {
  return database
      .Prepare(
          "INSERT INTO chunks (job, point, chunk, record) VALUES (?, ?, ?, ?)"
          " ON CONFLICT DO NOTHING")
      .Bind(job)
      .Bind(point)
      .Bind(chunk)
      .BindBlob(record)
      .Run();
}

absl::StatusOr<std::vector<std::string>> ReadChunks(Database& database, int64_t job,
                                                    int64_t point) {
  Query query =
      database.Prepare("SELECT record FROM chunks WHERE job = ? AND point = ? ORDER BY chunk");
  query.Bind(job).Bind(point);
  std::vector<std::string> records;
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return records;
    records.push_back(query.Bytes(0));
  }
}

absl::StatusOr<std::optional<std::string>> ReadCheckpoint(Database& database, int64_t job,
                                                          int64_t point) {
  Query query = database.Prepare("SELECT record FROM checkpoints WHERE job = ? AND point = ?");
  const absl::StatusOr<bool> row = query.Bind(job).Bind(point).Step();
  if (!row.ok()) return row.status();
  if (!*row) return std::nullopt;
  return query.Bytes(0);
}

absl::StatusOr<int64_t> InsertResult(Database& database, int64_t job, const PointRow& row) {
  int64_t number = 0;
  {
    Query query = database.Prepare(
        "INSERT INTO results (job, point, samples, result, finish)"
        " SELECT ?1, ?2, ?3, ?4, coalesce(max(finish), 0) + 1 FROM results WHERE job = ?1"
        " ON CONFLICT DO NOTHING RETURNING finish");
    query.Bind(job).Bind(row.point).Bind(row.samples).BindBlob(row.result);
    const absl::StatusOr<bool> inserted = query.Step();
    if (!inserted.ok()) return inserted.status();
    if (*inserted) number = query.Integer(0);
    if (const absl::StatusOr<bool> end = *inserted ? query.Step() : inserted; !end.ok()) {
      return end.status();
    }
  }
  if (number > 0 && !row.details.empty()) {
    const absl::Status inserted =
        database.Prepare("INSERT INTO details (job, point, record) VALUES (?, ?, ?)")
            .Bind(job)
            .Bind(row.point)
            .BindBlob(row.details)
            .Run();
    if (!inserted.ok()) return inserted;
  }
  if (!row.has_checkpoint) return number;
  for (const char* sql : {"DELETE FROM checkpoints WHERE job = ? AND point = ?",
                          "DELETE FROM chunks WHERE job = ? AND point = ?"}) {
    const absl::Status dropped = DropOfPoint(database, sql, job, row.point);
    if (!dropped.ok()) return dropped;
  }
  return number;
}

absl::StatusOr<int64_t> LastResultNumber(Database& database, int64_t job) {
  Query query = database.Prepare("SELECT coalesce(max(finish), 0) FROM results WHERE job = ?");
  const absl::StatusOr<bool> row = query.Bind(job).Step();
  if (!row.ok()) return row.status();
  return query.Integer(0);
}

absl::Status ReadResultsStoredAfter(
    Database& database, int64_t job, int64_t after,
    const std::function<bool(int64_t number, PointRow row)>& on_row) {
  Query query = database.Prepare(
      "SELECT finish, point, samples, result FROM results WHERE job = ? AND finish > ?"
      " ORDER BY finish");
  query.Bind(job).Bind(after);
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return absl::OkStatus();
    const int64_t number = query.Integer(0);
    if (!on_row(number, {query.Integer(1), query.Real(2), query.Bytes(3)})) {
      return absl::OkStatus();
    }
  }
}

absl::Status ReadResults(Database& database, int64_t job, int64_t first, Details details,
                         const std::function<bool(PointRow row)>& on_row) {
  const bool with_details = details == Details::kIncluded;
  Query query = database.Prepare(
      with_details ? "SELECT point, samples, result, record FROM results LEFT JOIN details USING "
                     "(job, point)"
                     " WHERE job = ? AND point >= ? ORDER BY point"
                   : "SELECT point, samples, result FROM results WHERE job = ? AND point >= ?"
                     " ORDER BY point");
  query.Bind(job).Bind(first);
  while (true) {
    const absl::StatusOr<bool> row = query.Step();
    if (!row.ok()) return row.status();
    if (!*row) return absl::OkStatus();
    PointRow read = {query.Integer(0), query.Real(1), query.Bytes(2)};
    if (with_details) read.details = query.Bytes(3);
    if (!on_row(std::move(read))) return absl::OkStatus();
  }
}

absl::StatusOr<int64_t> CountResults(Database& database, int64_t job) {
  Query query = database.Prepare("SELECT count(*) FROM results WHERE job = ?");
  const absl::StatusOr<bool> row = query.Bind(job).Step();
  if (!row.ok()) return row.status();
  return query.Integer(0);
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

absl::StatusOr<int64_t> BytesOfResults(Database& database, int64_t job) {
  Query query = database.Prepare(
      "SELECT (SELECT ifnull(sum(length(result)), 0) FROM results WHERE job = ?1)"
      " + (SELECT ifnull(sum(length(record)), 0) FROM details WHERE job = ?1)");
  const absl::StatusOr<bool> row = query.Bind(job).Step();
  if (!row.ok()) return row.status();
  return query.Integer(0);
}

}  // namespace ballpiston::server
