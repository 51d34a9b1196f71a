// The SQL about requests: for each Create, the job that it made or returned. Each function runs
// inside the transaction of its caller, which handles errors (sqlite.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/store/sqlite.h"

namespace ballpiston::server {

struct RequestRecord {
  std::string principal;
  std::string request_id;  // unique for the principal
  std::string payload;     // a hash of the request without its id
  int64_t job = 0;         // its sequence
  bool answered_from_store = false;
};

void InsertRequest(Database& database, const RequestRecord& record);

std::optional<RequestRecord> FindRequest(Database& database, const std::string& principal,
                                         const std::string& request_id);

// The number of requests with this job; counts at most `most`.
int64_t CountRequests(Database& database, int64_t job, int64_t most);

}  // namespace ballpiston::server
