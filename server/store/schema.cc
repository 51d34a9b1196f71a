#include "server/store/schema.h"

#include <sys/stat.h>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

// Checking every page takes about a second a gigabyte; beyond this size only the structure that
// opening it reads is checked.
constexpr int64_t kFullCheckBytes = int64_t{256} << 20;

constexpr char kTables[] = R"sql(
CREATE TABLE jobs (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  spec BLOB NOT NULL,
  state INTEGER NOT NULL,
  create_time INTEGER NOT NULL,
  start_time INTEGER,
  end_time INTEGER,
  error BLOB NOT NULL,
  engine_version TEXT NOT NULL,
  request_id TEXT UNIQUE,
  cancel_request_id TEXT,
  points INTEGER NOT NULL,
  points_done INTEGER NOT NULL,
  samples REAL NOT NULL
) STRICT;
CREATE INDEX jobs_by_state ON jobs (state);
CREATE TABLE blocks (
  job INTEGER NOT NULL,
  point INTEGER NOT NULL,
  block INTEGER NOT NULL,
  record BLOB NOT NULL,
  PRIMARY KEY (job, point, block)
) STRICT;
CREATE TABLE results (
  job INTEGER NOT NULL,
  point INTEGER NOT NULL,
  samples REAL NOT NULL,
  result BLOB NOT NULL,
  PRIMARY KEY (job, point)
) STRICT;
)sql";

// By version: what makes a store of the version before into one of this.
constexpr char kSecondVersion[] = R"sql(
ALTER TABLE jobs ADD COLUMN work REAL NOT NULL DEFAULT 0;
CREATE TABLE pilots (
  engine_version TEXT NOT NULL,
  rho REAL NOT NULL,
  delta REAL NOT NULL,
  epsilon REAL NOT NULL,
  difference REAL NOT NULL,
  standard_error REAL NOT NULL,
  PRIMARY KEY (engine_version, rho, delta, epsilon)
) STRICT;
)sql";

// A job gets its owner, its priority and the question that it answers; requests become rows of
// their own; results know the order in which they came.
constexpr char kThirdVersion[] = R"sql(
CREATE TABLE requests (
  principal TEXT NOT NULL,
  request_id TEXT NOT NULL,
  payload BLOB NOT NULL,
  job INTEGER NOT NULL,
  answered_from_store INTEGER NOT NULL,
  PRIMARY KEY (principal, request_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX requests_by_job ON requests (job);
CREATE TABLE new_jobs (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  principal TEXT NOT NULL,
  priority INTEGER NOT NULL,
  spec BLOB NOT NULL,
  question BLOB NOT NULL,
  state INTEGER NOT NULL,
  create_time INTEGER NOT NULL,
  start_time INTEGER,
  end_time INTEGER,
  error BLOB NOT NULL,
  engine_version TEXT NOT NULL,
  cancel_request_id TEXT,
  points INTEGER NOT NULL,
  points_done INTEGER NOT NULL,
  samples REAL NOT NULL,
  work REAL NOT NULL
) STRICT;
INSERT INTO new_jobs SELECT sequence, id, 'local', 0, spec, x'', state, create_time, start_time,
  end_time, error, engine_version, cancel_request_id, points, points_done, samples, work FROM jobs;
INSERT INTO sqlite_sequence SELECT 'new_jobs', 0
  WHERE NOT EXISTS (SELECT * FROM sqlite_sequence WHERE name = 'new_jobs');
UPDATE sqlite_sequence SET seq = (SELECT coalesce(max(seq), 0) FROM sqlite_sequence
  WHERE name IN ('jobs', 'new_jobs')) WHERE name = 'new_jobs';
INSERT INTO requests SELECT 'local', request_id, x'', sequence, 0 FROM jobs
  WHERE request_id IS NOT NULL;
DROP TABLE jobs;
ALTER TABLE new_jobs RENAME TO jobs;
CREATE INDEX jobs_by_state ON jobs (state, principal);
CREATE INDEX jobs_by_principal ON jobs (principal, sequence);
CREATE INDEX jobs_by_question ON jobs (principal, question) WHERE question <> x'';
ALTER TABLE results ADD COLUMN finish INTEGER NOT NULL DEFAULT 0;
UPDATE results SET finish = rowid;
CREATE INDEX results_by_finish ON results (job, finish);
)sql";

absl::Status Refused(const std::string& path, const std::string& why) {
  return absl::FailedPreconditionError(
      absl::StrCat("store ", path, " ", why,
                   "; it was left as it is: move it away, or choose another --data_dir"));
}

absl::Status CheckContents(const std::string& path, Database& database, int64_t bytes) {
  const auto application = database.Integer("PRAGMA application_id");
  const auto version = database.Integer("PRAGMA user_version");
  const auto tables = database.Integer("SELECT count(*) FROM sqlite_schema");
  for (const absl::Status& status : {application.status(), version.status(), tables.status()}) {
    if (!status.ok()) return Refused(path, absl::StrCat("is damaged (", status.message(), ")"));
  }
  if (*tables == 0 && *version == 0) return absl::OkStatus();  // made, and then interrupted
  if (*application != kApplicationId) return Refused(path, "is not a ballpiston store");
  if (*version > kSchemaVersion) {
    return Refused(path, absl::StrCat("has version ", *version,
                                      ", newer than this program's version ", kSchemaVersion));
  }
  if (bytes > kFullCheckBytes) return absl::OkStatus();
  const auto check = database.Text("PRAGMA quick_check(1)");
  if (check.ok() && *check == "ok") return absl::OkStatus();
  const std::string found = check.ok() ? *check : std::string(check.status().message());
  return Refused(path, absl::StrCat("is damaged (", found, ")"));
}

// Through a connection that cannot write.
absl::Status CheckFile(const std::string& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0 || found.st_size == 0) return absl::OkStatus();
  const auto database = Database::Open(path, Database::Mode::kReadOnly);
  if (!database.ok()) return Refused(path, std::string(database.status().message()));
  return CheckContents(path, **database, found.st_size);
}

absl::Status MakeTables(Database& database) {
  const auto version = database.Integer("PRAGMA user_version");
  if (!version.ok()) return version.status();
  if (*version == kSchemaVersion) return absl::OkStatus();
  const absl::Status made = database.Execute(absl::StrCat(
      "BEGIN IMMEDIATE;", *version < 1 ? kTables : "", *version < 2 ? kSecondVersion : "",
      kThirdVersion, "PRAGMA application_id = ", kApplicationId,
      "; PRAGMA user_version = ", kSchemaVersion, "; COMMIT;"));
  if (!made.ok()) database.Execute("ROLLBACK").IgnoreError();
  return made;
}

absl::Status Prepare(Database& database) {
  const auto mode = database.Text("PRAGMA journal_mode = WAL");
  if (!mode.ok()) return mode.status();
  if (*mode != "wal") return absl::UnavailableError("store: this file system has no WAL mode");
  // The log is cut back to 64 MiB after a checkpoint.
  const absl::Status set =
      database.Execute("PRAGMA synchronous = FULL; PRAGMA journal_size_limit = 67108864;");
  return set.ok() ? MakeTables(database) : set;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Database>> OpenStoreFile(const std::string& path) {
  const absl::Status checked = CheckFile(path);
  if (!checked.ok()) return checked;
  auto database = Database::Open(path, Database::Mode::kReadWrite);
  if (!database.ok()) return absl::PermissionDeniedError(database.status().message());
  const absl::Status prepared = Prepare(**database);
  if (!prepared.ok()) {
    return absl::PermissionDeniedError(absl::StrCat(path, ": ", prepared.message()));
  }
  return database;
}

}  // namespace ballpiston::server
