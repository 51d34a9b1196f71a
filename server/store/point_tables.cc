#include "server/store/point_tables.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace ballpiston::server {

void WriteCheckpoint(Database& database, int64_t job, int64_t point, int64_t chunk,
                     const std::string& record) {
  database.Run("DELETE FROM chunks WHERE job = ? AND point = ? AND chunk < ?", job, point, chunk);
  database.Run("INSERT OR REPLACE INTO checkpoints (job, point, record) VALUES (?, ?, ?)", job,
               point, Blob{record});
}

std::optional<std::string> ReadCheckpoint(Database& database, int64_t job, int64_t point) {
  return database.First<std::string>("SELECT record FROM checkpoints WHERE job = ? AND point = ?",
                                     job, point);
}

void InsertChunk(Database& database, int64_t job, int64_t point, int64_t chunk,
                 const std::string& record) {
  database.Run(
      "INSERT INTO chunks (job, point, chunk, record) VALUES (?, ?, ?, ?) ON CONFLICT DO NOTHING",
      job, point, chunk, Blob{record});
}

std::vector<std::string> ReadChunks(Database& database, int64_t job, int64_t point) {
  return database.All<std::string>(
      "SELECT record FROM chunks WHERE job = ? AND point = ? ORDER BY chunk", job, point);
}

int64_t InsertResult(Database& database, int64_t job, const PointRow& row) {
  const int64_t number = database.Integer(
      "INSERT INTO results (job, point, samples, finish, model, result, details, continuation)"
      " SELECT ?1, ?2, ?3, coalesce(max(finish), 0) + 1, ?4, ?5, ?6, ?7 FROM results"
      " WHERE job = ?1 ON CONFLICT DO NOTHING RETURNING finish",
      job, row.point, row.samples, row.end.model, Blob{row.result}, Blob{row.details},
      Blob{row.end.state});
  if (row.has_checkpoint) {
    database.Run("DELETE FROM checkpoints WHERE job = ? AND point = ?", job, row.point);
    database.Run("DELETE FROM chunks WHERE job = ? AND point = ?", job, row.point);
  }
  return number;
}

std::optional<PointEnd> ReadEnd(Database& database, int64_t job, int64_t point) {
  Query query = database.Select(
      "SELECT model, continuation FROM results WHERE job = ? AND point = ?"
      " AND continuation <> x''",
      job, point);
  if (!query.Next()) return std::nullopt;
  PointEnd end;
  query.ReadInto(end.model, end.state);
  return end;
}

void ReadResultsStoredAfter(Database& database, int64_t job, int64_t after,
                            absl::FunctionRef<bool(int64_t number, std::string result)> on_result) {
  Query query = database.Select(
      "SELECT finish, result FROM results WHERE job = ? AND finish > ? ORDER BY finish", job,
      after);
  while (query.Next() && on_result(query.Get<int64_t>(0), query.Get<std::string>(1))) continue;
}

void ReadResults(Database& database, int64_t job, int64_t first, Details details,
                 absl::FunctionRef<bool(PointRow row)> on_row) {
  const char* const column = details == Details::kIncluded ? "details" : "x''";
  Query query =
      database.Select(absl::StrCat("SELECT point, samples, result, ", column,
                                   " FROM results WHERE job = ? AND point >= ? ORDER BY point"),
                      job, first);
  PointRow row;
  while (query.Next()) {
    query.ReadInto(row.point, row.samples, row.result, row.details);
    if (!on_row(std::move(row))) return;
  }
}

int64_t CountResults(Database& database, int64_t job) {
  return database.Integer("SELECT count(*) FROM results WHERE job = ?", job);
}

std::vector<PointSize> ListFinishedPoints(Database& database, int64_t job) {
  std::vector<PointSize> points;
  Query query = database.Select(
      "SELECT point, samples, ? + length(result) + length(details) + length(continuation)"
      " FROM results WHERE job = ? ORDER BY point",
      kResultRow, job);
  while (query.Next()) {
    PointSize& point = points.emplace_back();
    query.ReadInto(point.point, point.samples, point.bytes);
  }
  return points;
}

}  // namespace ballpiston::server
