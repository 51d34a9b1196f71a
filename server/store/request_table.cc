#include "server/store/request_table.h"

namespace ballpiston::server {

void InsertRequest(Database& database, const RequestRecord& record) {
  database.Run(
      "INSERT INTO requests (principal, request_id, payload, job, answered_from_store)"
      " VALUES (?, ?, ?, ?, ?)",
      record.principal, record.request_id, Blob{record.payload}, record.job,
      record.answered_from_store);
}

std::optional<RequestRecord> FindRequest(Database& database, const std::string& principal,
                                         const std::string& request_id) {
  Query query = database.Select(
      "SELECT principal, request_id, payload, job, answered_from_store FROM requests"
      " WHERE principal = ? AND request_id = ?",
      principal, request_id);
  if (!query.Next()) return std::nullopt;
  RequestRecord found;
  query.ReadInto(found.principal, found.request_id, found.payload, found.job,
                 found.answered_from_store);
  return found;
}

int64_t CountRequests(Database& database, int64_t job, int64_t most) {
  return database.Integer("SELECT count(*) FROM (SELECT 1 FROM requests WHERE job = ? LIMIT ?)",
                          job, most);
}

}  // namespace ballpiston::server
