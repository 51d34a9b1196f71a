#include "server/store/sqlite.h"

#include <sqlite3.h>

#include <cerrno>

#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

// A reader never waits for the writer in WAL mode; this covers recovery after a crash.
constexpr int kBusyMilliseconds = 5000;

// SQLite reports a full disk as full, but a full quota as an input/output error.
bool IsOutOfSpace(int code, int system_error) {
  if ((code & 0xff) == SQLITE_FULL) return true;
  return (code & 0xff) == SQLITE_IOERR && (system_error == EDQUOT || system_error == ENOSPC);
}

absl::StatusCode CodeOf(int code, int system_error) {
  if (IsOutOfSpace(code, system_error)) return absl::StatusCode::kResourceExhausted;
  if ((code & 0xff) == SQLITE_CANTOPEN && system_error == EACCES) {
    return absl::StatusCode::kPermissionDenied;
  }
  switch (code & 0xff) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return absl::StatusCode::kDataLoss;
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return absl::StatusCode::kPermissionDenied;
    case SQLITE_CONSTRAINT:
    case SQLITE_MISMATCH:
    case SQLITE_TOOBIG:
    case SQLITE_RANGE:
      return absl::StatusCode::kInvalidArgument;
    case SQLITE_ERROR:
    case SQLITE_MISUSE:
    case SQLITE_INTERNAL:
      return absl::StatusCode::kInternal;
    default:
      return absl::StatusCode::kUnavailable;
  }
}

absl::Status Failure(sqlite3* connection) {
  const int code = sqlite3_extended_errcode(connection);
  return {CodeOf(code, sqlite3_system_errno(connection)),
          absl::StrCat("store: ", sqlite3_errmsg(connection))};
}

}  // namespace

bool IsOfTheDisk(const absl::Status& status) {
  bool has_payload = false;
  status.ForEachPayload([&](absl::string_view, const absl::Cord&) { has_payload = true; });
  if (has_payload) return false;
  return absl::IsUnavailable(status) || absl::IsResourceExhausted(status) ||
         absl::IsPermissionDenied(status);
}

void Query::Reset::operator()(sqlite3_stmt* statement) const {
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
}

void Query::BindInteger(int64_t value) {
  if (statement_) sqlite3_bind_int64(statement_.get(), next_parameter_++, value);
}

void Query::Bind(double value) {
  if (statement_) sqlite3_bind_double(statement_.get(), next_parameter_++, value);
}

void Query::Bind(std::optional<absl::Time> time) {
  if (time) return Bind(*time);
  if (statement_) sqlite3_bind_null(statement_.get(), next_parameter_++);
}

void Query::Bind(absl::string_view text) {
  if (!statement_) return;
  sqlite3_bind_text64(statement_.get(), next_parameter_++, text.data(), text.size(),
                      SQLITE_TRANSIENT, SQLITE_UTF8);
}

void Query::Bind(Blob blob) {
  if (!statement_) return;
  // A null pointer would bind NULL.
  const char* data = blob.bytes.empty() ? "" : blob.bytes.data();
  sqlite3_bind_blob64(statement_.get(), next_parameter_++, data, blob.bytes.size(),
                      SQLITE_TRANSIENT);
}

bool Query::Next() {
  if (!statement_ || !database_.status().ok()) return false;
  const int code = sqlite3_step(statement_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_.Fail(Failure(database_.connection_));
  return code == SQLITE_ROW;
}

int64_t Query::Integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }

double Query::Real(int column) const { return sqlite3_column_double(statement_.get(), column); }

std::string Query::Bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return data == nullptr ? std::string()
                         : std::string(static_cast<const char*>(data), static_cast<size_t>(size));
}

absl::StatusOr<std::unique_ptr<Database>> Database::Open(const std::string& path, Mode mode) {
  const int flags =
      mode == Mode::kReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  sqlite3* connection = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &connection, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  auto database = std::unique_ptr<Database>(new Database(connection));
  if (code != SQLITE_OK) return Failure(connection);
  sqlite3_extended_result_codes(connection, 1);
  sqlite3_busy_timeout(connection, kBusyMilliseconds);
  return database;
}

bool Database::Exists(const std::string& path) {
  sqlite3_vfs* const files = sqlite3_vfs_find(nullptr);
  int exists = 0;
  return files != nullptr &&
         files->xAccess(files, path.c_str(), SQLITE_ACCESS_EXISTS, &exists) == SQLITE_OK &&
         exists != 0;
}

void Database::RemoveFile(const std::string& path) {
  sqlite3_vfs* const files = sqlite3_vfs_find(nullptr);
  if (files != nullptr) files->xDelete(files, path.c_str(), 0);
}

Database::~Database() {
  for (const auto& [sql, statement] : statements_) sqlite3_finalize(statement);
  sqlite3_close(connection_);
}

Query Database::Prepare(const std::string& sql) {
  const auto known = statements_.find(sql);
  if (known != statements_.end()) return {*this, known->second};
  if (!status_.ok()) return {*this, nullptr};
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v3(connection_, sql.c_str(), -1, SQLITE_PREPARE_PERSISTENT,
                                      &statement, nullptr);
  if (code != SQLITE_OK) Fail(Failure(connection_));
  if (code == SQLITE_OK) statements_.emplace(sql, statement);
  return {*this, statement};
}

void Database::Execute(const std::string& sql) {
  if (!status_.ok()) return;
  if (sqlite3_exec(connection_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    Fail(Failure(connection_));
  }
}

void Database::Rollback() { sqlite3_exec(connection_, "ROLLBACK", nullptr, nullptr, nullptr); }

std::string Database::FileStart(int bytes) {
  sqlite3_file* file = nullptr;
  sqlite3_file_control(connection_, "main", SQLITE_FCNTL_FILE_POINTER, &file);
  std::string start(static_cast<size_t>(bytes), '\0');
  const int code = file == nullptr || file->pMethods == nullptr
                       ? SQLITE_CANTOPEN
                       : file->pMethods->xRead(file, start.data(), bytes, 0);
  if (code == SQLITE_OK || code == SQLITE_IOERR_SHORT_READ) return start;
  Fail(absl::UnavailableError(absl::StrCat("store: ", sqlite3_errstr(code))));
  return start;
}

int64_t Database::LastInsertedRow() const { return sqlite3_last_insert_rowid(connection_); }

}  // namespace ballpiston::server
