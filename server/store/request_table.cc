#include "server/store/request_table.h"

namespace ballpiston::server {

absl::Status InsertRequest(Database& database, const RequestRecord& record) {
  return database.Run(
      "INSERT INTO requests (principal, request_id, payload, job, answered_from_store)"
      " VALUES (?, ?, ?, ?, ?)",
      record.principal, record.request_id, Blob{record.payload}, record.job,
      record.answered_from_store);
}

absl::StatusOr<std::optional<RequestRecord>> FindRequest(Database& database,
                                                         const std::string& principal,
                                                         const std::string& request_id) {
  std::optional<RequestRecord> found;
  const absl::Status read = database
                                .Select(
                                    "SELECT payload, job, answered_from_store FROM requests"
                                    " WHERE principal = ? AND request_id = ?",
                                    principal, request_id)
                                .ForEach([&](const Query& row) {
                                  found = {.principal = principal,
                                           .request_id = request_id,
                                           .payload = row.Bytes(0),
                                           .job = row.Integer(1),
                                           .answered_from_store = row.Integer(2) != 0};
                                  return true;
                                });
  if (!read.ok()) return read;
  return found;
}

absl::StatusOr<int64_t> CountRequests(Database& database, int64_t job, int64_t most) {
  return database.Integer("SELECT count(*) FROM (SELECT 1 FROM requests WHERE job = ? LIMIT ?)",
                          job, most);
}

}  // namespace ballpiston::server
