#include "server/store/schema.h"

#include <sys/stat.h>
#include <unistd.h>

#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

// Checking every page takes about a second a gigabyte; beyond this size only the structure that
// opening it reads is checked.
constexpr int64_t kFullCheckBytes = int64_t{256} << 20;
constexpr int64_t kFirstPageBytes = 4096;  // a new store has no more before it has its tables

constexpr char kTables[] = R"sql(
CREATE TABLE jobs (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  principal TEXT NOT NULL,
  priority INTEGER NOT NULL,
  pinned INTEGER NOT NULL,
  bytes INTEGER NOT NULL,
  spec BLOB NOT NULL,
  question BLOB NOT NULL,
  state INTEGER NOT NULL,
  create_time INTEGER NOT NULL,
  start_time INTEGER,
  end_time INTEGER,
  expired_time INTEGER,
  error BLOB NOT NULL,
  engine_version TEXT NOT NULL,
  restarts INTEGER NOT NULL,
  cancel_request_id TEXT,
  points INTEGER NOT NULL,
  points_done INTEGER NOT NULL,
  samples REAL NOT NULL,
  work REAL NOT NULL,
  grid BLOB NOT NULL  -- last, because SQLite reads a row up to the columns that are asked for
) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, principal, points);
CREATE INDEX jobs_by_principal ON jobs (principal, sequence, bytes, state);
CREATE INDEX jobs_that_may_expire ON jobs (end_time, bytes)
  WHERE end_time IS NOT NULL AND expired_time IS NULL AND pinned = 0;
CREATE INDEX jobs_that_expired ON jobs (end_time, bytes) WHERE expired_time IS NOT NULL;
CREATE INDEX jobs_by_question ON jobs (principal, question) WHERE question <> x'';
CREATE TABLE requests (
  principal TEXT NOT NULL,
  request_id TEXT NOT NULL,
  payload BLOB NOT NULL,
  job INTEGER NOT NULL,
  answered_from_store INTEGER NOT NULL,
  PRIMARY KEY (principal, request_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX requests_by_job ON requests (job);
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
  result BLOB NOT NULL,
  finish INTEGER NOT NULL,
  PRIMARY KEY (job, point)
) STRICT;
CREATE TABLE details (
  job INTEGER NOT NULL,
  point INTEGER NOT NULL,
  record BLOB NOT NULL,
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

absl::Status Refused(const std::string& path, const std::string& why) {
  return absl::FailedPreconditionError(absl::StrCat(
      "store ", path, " ", why, "; it is unchanged: move it away, or choose another --data-dir"));
}

// The disk is full or fails, or the file belongs to another user. This says nothing about the
// file's content.
absl::Status NotUsable(const std::string& path, const absl::Status& found) {
  return absl::UnavailableError(absl::StrCat(
      "store ", path, " cannot be used now (", found.message(),
      "); it is unchanged: check that its disk works and has room, and that the file belongs to "
      "this user"));
}

absl::Status RefusedFor(const std::string& path, const absl::Status& found) {
  const bool is_of_its_place = absl::IsUnavailable(found) || absl::IsResourceExhausted(found);
  if (is_of_its_place) return NotUsable(path, found);
  return Refused(path, absl::StrCat("is damaged (", found.message(), ")"));
}

bool IsFolder(const std::string& path) {
  struct stat found {};
  return stat(path.c_str(), &found) == 0 && S_ISDIR(found.st_mode);
}

// A store with tables has a log beside it; bytes 18 and 19 of its header say so. A file without
// this mark but with a log beside it is a backup that replaced another store: SQLite would read the
// other store's pages into it.
absl::Status CheckLog(const std::string& path, const Database& database, const std::string& vfs) {
  const auto start = database.FileStart(20);
  if (!start.ok()) return RefusedFor(path, start.status());
  const bool empty = start->front() == '\0';
  const bool logged = (*start)[18] == 2 && (*start)[19] == 2;
  if (empty || logged || !Database::Exists(path + "-wal", vfs)) return absl::OkStatus();
  return Refused(path, absl::StrCat("has the log of another store beside it: move ", path,
                                    "-wal away if this is a restored copy"));
}

// Checks that the file is a store. `unfinished`: the creation of the store was interrupted.
absl::Status CheckKind(const std::string& path, Database& database, bool& unfinished) {
  const auto application = database.Integer("PRAGMA application_id");
  const auto version = database.Integer("PRAGMA user_version");
  const auto tables = database.Integer("SELECT count(*) FROM sqlite_schema");
  for (const absl::Status& status : {application.status(), version.status(), tables.status()}) {
    if (!status.ok()) return RefusedFor(path, status);
  }
  unfinished = *tables == 0 && *version == 0 && *application == 0;
  if (unfinished) return absl::OkStatus();
  if (*application != kApplicationId) return Refused(path, "is not a ballpiston store");
  if (*version > kSchemaVersion) {
    return Refused(path, absl::StrCat("has version ", *version,
                                      ", newer than this program's version ", kSchemaVersion));
  }
  if (*version >= 1 && *version < kSchemaVersion) {
    return Refused(path, absl::StrCat("has version ", *version,
                                      ", older than this program's version ", kSchemaVersion));
  }
  if (*version < 1) return Refused(path, absl::StrCat("is damaged (version ", *version, ")"));
  return absl::OkStatus();
}

absl::Status CheckContents(const std::string& path, Database& database) {
  bool unfinished = false;
  const absl::Status kind = CheckKind(path, database, unfinished);
  if (!kind.ok() || unfinished) return kind;
  const auto bytes = database.FileBytes();
  if (!bytes.ok()) return RefusedFor(path, bytes.status());
  if (*bytes > kFullCheckBytes) return absl::OkStatus();
  const auto check = database.Text("PRAGMA quick_check(1)");
  if (!check.ok()) return RefusedFor(path, check.status());
  return *check == "ok" ? check.status() : RefusedFor(path, absl::DataLossError(*check));
}

// Whether the creation of the store was interrupted when it was still empty. A journal then has the
// undo data, which the writing connection applies.
bool WasInterruptedAtFirstPage(const std::string& path, const Database& database,
                               const std::string& vfs) {
  const auto bytes = database.FileBytes();
  return bytes.ok() && *bytes <= kFirstPageBytes && Database::Exists(path + "-journal", vfs);
}

// A read-only connection also creates an empty log and its index if they do not exist. This class
// removes them if the file is rejected, unless another process has written to the log meanwhile.
class LogOfRefused {
 public:
  LogOfRefused(const std::string& path, const std::string& vfs) {
    if (!vfs.empty()) return;
    for (const char* suffix : {"-wal", "-shm"}) {
      if (access((path + suffix).c_str(), F_OK) != 0) added_.push_back(path + suffix);
    }
  }
  ~LogOfRefused() {
    for (const std::string& file : added_) {  // the log first
      struct stat found {};
      const bool is_log = file.ends_with("-wal");
      if (is_log && stat(file.c_str(), &found) == 0 && found.st_size > 0) return;
      unlink(file.c_str());
    }
  }

  void Keep() { added_.clear(); }

 private:
  std::vector<std::string> added_;
};

// Through a connection that cannot write.
absl::Status CheckFileToRead(const std::string& path, const std::string& vfs) {
  const auto database = Database::Open(path, Database::Mode::kReadOnly, vfs);
  if (!database.ok()) return RefusedFor(path, database.status());
  if (WasInterruptedAtFirstPage(path, **database, vfs)) return absl::OkStatus();
  const absl::Status log = CheckLog(path, **database, vfs);
  return log.ok() ? CheckContents(path, **database) : log;
}

absl::Status CheckFile(const std::string& path, const std::string& vfs) {
  if (IsFolder(path)) return Refused(path, "is a folder, not a file");
  if (!Database::Exists(path, vfs)) return absl::OkStatus();
  LogOfRefused log(path, vfs);
  const absl::Status checked = CheckFileToRead(path, vfs);
  if (checked.ok()) log.Keep();
  return checked;
}

absl::Status MakeTables(Database& database) {
  const auto version = database.Integer("PRAGMA user_version");
  if (!version.ok()) return version.status();
  if (*version == kSchemaVersion) return absl::OkStatus();
  const absl::Status made = database.Execute(
      absl::StrCat("BEGIN IMMEDIATE;", kTables, "PRAGMA application_id = ", kApplicationId,
                   "; PRAGMA user_version = ", kSchemaVersion, "; COMMIT;"));
  if (!made.ok()) database.Execute("ROLLBACK").IgnoreError();
  return made;
}

absl::Status Prepare(Database& database) {
  // These settings come before the first page is written. auto_vacuum: the file can give free pages
  // back. secure_delete: Debian's SQLite would overwrite deleted rows with zeros, which would take
  // as much room in the log as the rows did. synchronous: with EXTRA no power cut brings back the
  // journal of this write beside the log, which is made next.
  const absl::Status frees = database.Execute(
      "PRAGMA synchronous = EXTRA; PRAGMA auto_vacuum = INCREMENTAL; PRAGMA secure_delete = OFF;");
  if (!frees.ok()) return frees;
  const auto mode = database.Text("PRAGMA journal_mode = WAL");
  if (!mode.ok()) return mode.status();
  if (*mode != "wal") return absl::UnavailableError("store: this file system has no WAL mode");
  // The log is cut back to 64 MiB after a checkpoint.
  const absl::Status set =
      database.Execute("PRAGMA synchronous = FULL; PRAGMA journal_size_limit = 67108864;");
  return set.ok() ? MakeTables(database) : set;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Database>> OpenStoreToRead(const std::string& path,
                                                          const std::string& vfs) {
  if (IsFolder(path)) return Refused(path, "is a folder, not a file");
  if (!Database::Exists(path, vfs)) {
    return absl::NotFoundError(absl::StrCat("there is no store ", path));
  }
  auto database = Database::Open(path, Database::Mode::kReadOnly, vfs);
  if (!database.ok()) return RefusedFor(path, database.status());
  const absl::Status log = CheckLog(path, **database, vfs);
  if (!log.ok()) return log;
  bool unfinished = false;
  const absl::Status kind = CheckKind(path, **database, unfinished);
  if (!kind.ok()) return kind;
  if (unfinished) return Refused(path, "has no tables yet");
  return database;
}

absl::StatusOr<std::unique_ptr<Database>> OpenStoreFile(const std::string& path,
                                                        const std::string& vfs) {
  const absl::Status checked = CheckFile(path, vfs);
  if (!checked.ok()) return checked;
  auto database = Database::Open(path, Database::Mode::kReadWrite, vfs);
  if (!database.ok()) return absl::PermissionDeniedError(database.status().message());
  bool unfinished = false;  // again: opening may have undone an interrupted change
  const absl::Status kind = CheckKind(path, **database, unfinished);
  if (!kind.ok()) return kind;
  const absl::Status prepared = Prepare(**database);
  if (prepared.ok()) return database;
  if (!absl::IsPermissionDenied(prepared)) return RefusedFor(path, prepared);
  return absl::PermissionDeniedError(absl::StrCat(path, ": ", prepared.message()));
}

}  // namespace ballpiston::server
