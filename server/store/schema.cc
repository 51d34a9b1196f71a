#include "server/store/schema.h"

#include <sys/stat.h>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

// Checking every page takes 1 to 5 seconds a gigabyte; beyond this size only the structure that
// opening it reads is checked.
constexpr int64_t kFullCheckBytes = int64_t{256} << 20;

// SQLite reads a row up to the last column that is asked for. So the columns that lists and watches
// read come first in `jobs` and `results`. The large columns come last: the grid, the details, and
// the state from which another job continues the point.
constexpr char kTables[] = R"sql(
CREATE TABLE jobs (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  principal TEXT NOT NULL,
  request_id TEXT NOT NULL,
  payload BLOB NOT NULL,
  points INTEGER NOT NULL,
  question BLOB NOT NULL DEFAULT x'',
  family BLOB NOT NULL DEFAULT x'',
  restarts INTEGER NOT NULL DEFAULT 0,
  cancel_request_id TEXT NOT NULL DEFAULT '',
  state INTEGER NOT NULL DEFAULT 0,
  end_time INTEGER,
  expired INTEGER NOT NULL DEFAULT 0,
  pinned INTEGER NOT NULL DEFAULT 0,
  bytes INTEGER NOT NULL DEFAULT 0,
  points_done INTEGER NOT NULL DEFAULT 0,
  samples REAL NOT NULL DEFAULT 0,
  message BLOB NOT NULL DEFAULT x'',
  grid BLOB NOT NULL
) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, principal, points);
CREATE INDEX jobs_by_principal ON jobs (principal, sequence, bytes, state);
CREATE INDEX jobs_that_may_expire ON jobs (end_time, principal, bytes, expired, pinned)
  WHERE end_time IS NOT NULL AND expired = 0 AND pinned = 0;
CREATE INDEX jobs_that_expired ON jobs (end_time, principal, bytes, expired) WHERE expired = 1;
CREATE INDEX jobs_that_are_pinned ON jobs (principal, bytes, pinned, state) WHERE pinned = 1;
CREATE INDEX jobs_by_question ON jobs (principal, question)
  WHERE question <> x'' AND state = 4 AND expired = 0;
CREATE INDEX jobs_by_family ON jobs (principal, family, samples DESC)
  WHERE family <> x'' AND state = 4 AND expired = 0;
CREATE UNIQUE INDEX jobs_by_request ON jobs (principal, request_id) WHERE request_id <> '';
CREATE INDEX jobs_by_cancellation ON jobs (principal, cancel_request_id)
  WHERE cancel_request_id <> '';
CREATE TABLE checkpoints (
  job INTEGER NOT NULL,
  point INTEGER NOT NULL,
  record BLOB NOT NULL,
  PRIMARY KEY (job, point)
) STRICT;
CREATE TABLE chunks (
  job INTEGER NOT NULL,
  point INTEGER NOT NULL,
  chunk INTEGER NOT NULL,
  record BLOB NOT NULL,
  PRIMARY KEY (job, point, chunk)
) STRICT;
CREATE TABLE results (
  job INTEGER NOT NULL,
  point INTEGER NOT NULL,
  samples REAL NOT NULL,
  finish INTEGER NOT NULL,
  model INTEGER NOT NULL,
  result BLOB NOT NULL,
  details BLOB NOT NULL,
  continuation BLOB NOT NULL,
  PRIMARY KEY (job, point)
) STRICT;
CREATE TABLE dropped (
  job INTEGER PRIMARY KEY
) STRICT;
CREATE INDEX results_by_finish ON results (job, finish);
CREATE TABLE server (
  identity TEXT NOT NULL
) STRICT;
INSERT INTO server (identity) VALUES (lower(hex(randomblob(8))));
)sql";

absl::Status Refused(const std::string& path, const std::string& why) {
  return absl::FailedPreconditionError(absl::StrCat(
      "store ", path, " ", why, "; it is unchanged: move it away, or use another data folder"));
}

// If the disk is full or fails, or the file belongs to another user, the error says nothing about
// the file's content.
absl::Status RefusedFor(const std::string& path, const absl::Status& found) {
  if (absl::IsPermissionDenied(found)) {
    return absl::PermissionDeniedError(
        absl::StrCat("store ", path, " cannot be opened by this user (", found.message(), ")"));
  }
  if (!absl::IsUnavailable(found) && !absl::IsResourceExhausted(found)) {
    return Refused(path, absl::StrCat("is damaged (", found.message(), ")"));
  }
  return absl::UnavailableError(absl::StrCat(
      "store ", path, " cannot be used now (", found.message(),
      "); it is unchanged: check that its disk works and has room, and that the file belongs to "
      "this user"));
}

// A store with tables has a log beside it; bytes 18 and 19 of its header say so. A file without
// this mark but with a log beside it is a backup that replaced another store: SQLite would read the
// other store's pages into it.
absl::Status CheckLog(const std::string& path, Database& database) {
  const std::string start = database.FileStart(20);
  if (!database.status().ok()) return RefusedFor(path, database.TakeStatus());
  const bool empty = start.front() == '\0';
  const bool logged = start[18] == 2 && start[19] == 2;
  if (empty || logged || !Database::Exists(path + "-wal")) return absl::OkStatus();
  return Refused(path, absl::StrCat("has the log of another store beside it: move ", path,
                                    "-wal away if this is a restored copy"));
}

// Checks that the file is a store. `unfinished`: the creation of the store was interrupted.
absl::Status CheckKind(const std::string& path, Database& database, bool& unfinished) {
  const int64_t application = database.Integer("PRAGMA application_id");
  const int64_t version = database.Integer("PRAGMA user_version");
  const int64_t tables = database.Integer("SELECT count(*) FROM sqlite_schema");
  if (!database.status().ok()) return RefusedFor(path, database.TakeStatus());
  unfinished = tables == 0 && version == 0 && application == 0;
  if (unfinished || (application == kApplicationId && version == kSchemaVersion)) {
    return absl::OkStatus();
  }
  if (application != kApplicationId) return Refused(path, "is not a ballpiston store");
  if (version < 1) return Refused(path, absl::StrCat("is damaged (version ", version, ")"));
  return Refused(
      path, absl::StrCat("has version ", version, version > kSchemaVersion ? ", newer" : ", older",
                         " than this program's version ", kSchemaVersion));
}

// Through a connection that cannot write. Sets `unfinished` as CheckKind does.
absl::StatusOr<std::unique_ptr<Database>> OpenChecked(const std::string& path, bool& unfinished) {
  struct stat found {};
  const bool is_folder = stat(path.c_str(), &found) == 0 && S_ISDIR(found.st_mode);
  if (is_folder) return Refused(path, "is a folder, not a file");
  auto database = Database::Open(path, Database::Mode::kReadOnly);
  if (!database.ok()) return RefusedFor(path, database.status());
  absl::Status checked = CheckLog(path, **database);
  if (checked.ok()) checked = CheckKind(path, **database, unfinished);
  return checked.ok() ? std::move(database) : checked;
}

absl::Status CheckPages(const std::string& path, Database& database) {
  const int64_t bytes =
      database.Integer("PRAGMA page_count") * database.Integer("PRAGMA page_size");
  if (bytes > kFullCheckBytes) return absl::OkStatus();
  const auto check = database.First<std::string>("PRAGMA quick_check(1)");
  if (check != "ok") database.Fail(absl::DataLossError(check.value_or("")));
  const absl::Status status = database.TakeStatus();
  return status.ok() ? status : RefusedFor(path, status);
}

// A journal beside the file is left by an interrupted creation: it has the undo data, which the
// writing connection applies.
absl::Status CheckFile(const std::string& path) {
  if (!Database::Exists(path) || Database::Exists(path + "-journal")) return absl::OkStatus();
  bool unfinished = false;
  const auto database = OpenChecked(path, unfinished);
  if (!database.ok() || unfinished) return database.status();
  return CheckPages(path, **database);
}

void MakeTables(Database& database) {
  if (database.Integer("PRAGMA user_version") == kSchemaVersion) return;
  database.Execute(absl::StrCat("BEGIN IMMEDIATE;", kTables,
                                "PRAGMA application_id = ", kApplicationId,
                                "; PRAGMA user_version = ", kSchemaVersion, "; COMMIT;"));
  database.Rollback();  // after an error
}

absl::Status Prepare(Database& database) {
  // These settings come before the first page is written. auto_vacuum: the file can give free pages
  // back. secure_delete: Debian's SQLite would overwrite deleted rows with zeros, which would take
  // as much room in the log as the rows did. synchronous: with EXTRA no power cut brings back the
  // journal of this write beside the log, which is made next.
  database.Execute(
      "PRAGMA synchronous = EXTRA; PRAGMA auto_vacuum = INCREMENTAL; PRAGMA secure_delete = OFF;");
  if (database.First<std::string>("PRAGMA journal_mode = WAL") != "wal") {
    database.Fail(absl::UnavailableError("store: this file system has no WAL mode"));
  }
  // The log is cut back to 64 MiB after a checkpoint.
  database.Execute("PRAGMA synchronous = FULL; PRAGMA journal_size_limit = 67108864;");
  MakeTables(database);
  return database.TakeStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<Database>> OpenStoreToRead(const std::string& path) {
  if (!Database::Exists(path)) {
    return absl::NotFoundError(absl::StrCat("there is no store ", path));
  }
  bool unfinished = false;
  auto database = OpenChecked(path, unfinished);
  return unfinished ? Refused(path, "has no tables yet") : std::move(database);
}

absl::StatusOr<std::unique_ptr<Database>> OpenStoreFile(const std::string& path) {
  const absl::Status checked = CheckFile(path);
  if (!checked.ok()) return checked;
  auto database = Database::Open(path, Database::Mode::kReadWrite);
  if (!database.ok()) return RefusedFor(path, database.status());
  bool unfinished = false;  // again: opening may have undone an interrupted change
  const absl::Status kind = CheckKind(path, **database, unfinished);
  if (!kind.ok()) return kind;
  const absl::Status prepared = Prepare(**database);
  if (prepared.ok()) return database;
  return RefusedFor(path, prepared);
}

}  // namespace ballpiston::server
