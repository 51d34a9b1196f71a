// The store's tables as the first version of the schema made them.
#ifndef BALLPISTON_TESTS_SERVER_FIRST_STORE_VERSION_H_
#define BALLPISTON_TESTS_SERVER_FIRST_STORE_VERSION_H_

namespace ballpiston::server {

inline constexpr char kTablesOfVersion1[] = R"sql(
CREATE TABLE jobs (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE, spec BLOB NOT NULL,
  state INTEGER NOT NULL, create_time INTEGER NOT NULL, start_time INTEGER, end_time INTEGER,
  error BLOB NOT NULL, engine_version TEXT NOT NULL, request_id TEXT UNIQUE,
  cancel_request_id TEXT, points INTEGER NOT NULL, points_done INTEGER NOT NULL,
  samples REAL NOT NULL) STRICT;
CREATE INDEX jobs_by_state ON jobs (state);
CREATE TABLE blocks (job INTEGER NOT NULL, point INTEGER NOT NULL, block INTEGER NOT NULL,
  record BLOB NOT NULL, PRIMARY KEY (job, point, block)) STRICT;
CREATE TABLE results (job INTEGER NOT NULL, point INTEGER NOT NULL, samples REAL NOT NULL,
  result BLOB NOT NULL, PRIMARY KEY (job, point)) STRICT;
PRAGMA user_version = 1;
)sql";

}  // namespace ballpiston::server

#endif  // BALLPISTON_TESTS_SERVER_FIRST_STORE_VERSION_H_
