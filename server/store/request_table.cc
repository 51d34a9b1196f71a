#include "server/store/request_table.h"

namespace ballpiston::server {

absl::Status InsertRequest(Database& database, const RequestRecord& record) {
  return database
      .Prepare(
          "INSERT INTO requests (principal, request_id, payload, job, answered_from_store)"
          " VALUES (?, ?, ?, ?, ?)")
      .BindText(record.principal)
      .BindText(record.request_id)
      .BindBlob(record.payload)
      .Bind(record.job)
      .Bind(int64_t{record.answered_from_store})
      .Run();
}

absl::StatusOr<std::optional<RequestRecord>> FindRequest(Database& database,
                                                         const std::string& principal,
                                                         const std::string& request_id) {
  Query query = database.Prepare(
      "SELECT payload, job, answered_from_store FROM requests"
      " WHERE principal = ? AND request_id = ?");
  const absl::StatusOr<bool> row = query.BindText(principal).BindText(request_id).Step();
  if (!row.ok()) return row.status();
  if (!*row) return std::nullopt;
  return RequestRecord{.principal = principal,
                       .request_id = request_id,
                       .payload = query.Bytes(0),
                       .job = query.Integer(1),
                       .answered_from_store = query.Integer(2) != 0};
}

absl::StatusOr<int64_t> CountRequests(Database& database, int64_t job, int64_t most) {
  Query query =
      database.Prepare("SELECT count(*) FROM (SELECT 1 FROM requests WHERE job = ? LIMIT ?)");
  const absl::StatusOr<bool> row = query.Bind(job).Bind(most).Step();
  if (!row.ok()) return row.status();
  return query.Integer(0);
}

}  // namespace ballpiston::server
