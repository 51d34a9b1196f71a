#include "server/store/point_tables.h"

#include <utility>

namespace ballpiston::server {

absl::Status WriteCheckpoint(Database& database, int64_t job, int64_t point, int64_t chunk,
                             const std::string& record) {
  const absl::Status dropped = database.Run(
      "DELETE FROM chunks WHERE job = ? AND point = ? AND chunk < ?", job, point, chunk);
  if (!dropped.ok()) return dropped;
  return database.Run("INSERT OR REPLACE INTO checkpoints (job, point, record) VALUES (?, ?, ?)",
                      job, point, Blob{record});
}

absl::StatusOr<std::optional<std::string>> ReadCheckpoint(Database& database, int64_t job,
                                                          int64_t point) {
  std::optional<std::string> record;
  const absl::Status read =
      database.Select("SELECT record FROM checkpoints WHERE job = ? AND point = ?", job, point)
          .ForEach([&](const Query& row) {
            record = row.Bytes(0);
            return true;
          });
  if (!read.ok()) return read;
  return record;
}

absl::Status InsertChunk(Database& database, int64_t job, int64_t point, int64_t chunk,
                         const std::string& record) {
  return database.Run(
      "INSERT INTO chunks (job, point, chunk, record) VALUES (?, ?, ?, ?) ON CONFLICT DO NOTHING",
      job, point, chunk, Blob{record});
}

absl::StatusOr<std::vector<std::string>> ReadChunks(Database& database, int64_t job,
                                                    int64_t point) {
  std::vector<std::string> records;
  const absl::Status read =
      database
          .Select("SELECT record FROM chunks WHERE job = ? AND point = ? ORDER BY chunk", job,
                  point)
          .ForEach([&](const Query& row) {
            records.push_back(row.Bytes(0));
            return true;
          });
  if (!read.ok()) return read;
  return records;
}

absl::StatusOr<int64_t> InsertResult(Database& database, int64_t job, const PointRow& row) {
  int64_t number = 0;
  absl::Status status =
      database
          .Select(
              "INSERT INTO results (job, point, samples, result, finish)"
              " SELECT ?1, ?2, ?3, ?4, coalesce(max(finish), 0) + 1 FROM results WHERE job = ?1"
              " ON CONFLICT DO NOTHING RETURNING finish",
              job, row.point, row.samples, Blob{row.result})
          .ForEach([&](const Query& inserted) {
            number = inserted.Integer(0);
            return true;
          });
  if (status.ok() && number > 0 && !row.details.empty()) {
    status = database.Run("INSERT INTO details (job, point, record) VALUES (?, ?, ?)", job,
                          row.point, Blob{row.details});
  }
  for (const char* table : {"checkpoints", "chunks"}) {
    if (!status.ok() || !row.has_checkpoint) break;
    status = database.Run(std::string("DELETE FROM ") + table + " WHERE job = ? AND point = ?", job,
                          row.point);
  }
  if (!status.ok()) return status;
  return number;
}

absl::StatusOr<int64_t> LastResultNumber(Database& database, int64_t job) {
  return database.Integer("SELECT coalesce(max(finish), 0) FROM results WHERE job = ?", job);
}

absl::Status ReadResultsStoredAfter(
    Database& database, int64_t job, int64_t after,
    const std::function<bool(int64_t number, PointRow row)>& on_row) {
  return database
      .Select(
          "SELECT finish, point, samples, result FROM results WHERE job = ? AND finish > ?"
          " ORDER BY finish",
          job, after)
      .ForEach([&](const Query& row) {
        return on_row(row.Integer(0), {row.Integer(1), row.Real(2), row.Bytes(3)});
      });
}

absl::Status ReadResults(Database& database, int64_t job, int64_t first, Details details,
                         const std::function<bool(PointRow row)>& on_row) {
  const bool with_details = details == Details::kIncluded;
  const char* const sql = with_details ? "SELECT point, samples, result, record FROM results"
                                         " LEFT JOIN details USING (job, point)"
                                         " WHERE job = ? AND point >= ? ORDER BY point"
                                       : "SELECT point, samples, result FROM results"
                                         " WHERE job = ? AND point >= ? ORDER BY point";
  return database.Select(sql, job, first).ForEach([&](const Query& row) {
    PointRow read = {row.Integer(0), row.Real(1), row.Bytes(2)};
    if (with_details) read.details = row.Bytes(3);
    return on_row(std::move(read));
  });
}

absl::StatusOr<int64_t> CountResults(Database& database, int64_t job) {
  return database.Integer("SELECT count(*) FROM results WHERE job = ?", job);
}

absl::StatusOr<std::vector<PointRow>> ListFinishedPoints(Database& database, int64_t job) {
  std::vector<PointRow> rows;
  const absl::Status read =
      database.Select("SELECT point, samples FROM results WHERE job = ? ORDER BY point", job)
          .ForEach([&](const Query& row) {
            rows.push_back({row.Integer(0), row.Real(1), std::string()});
            return true;
          });
  if (!read.ok()) return read;
  return rows;
}

absl::StatusOr<int64_t> BytesOfResults(Database& database, int64_t job) {
  return database.Integer(
      "SELECT (SELECT ifnull(sum(length(result)), 0) FROM results WHERE job = ?1)"
      " + (SELECT ifnull(sum(length(record)), 0) FROM details WHERE job = ?1)",
      job);
}

}  // namespace ballpiston::server
